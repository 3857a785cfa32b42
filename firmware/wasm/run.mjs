// node run.mjs firmware_wasm.wasm: the common jobs, one line each.
import fs from 'node:fs';

const { instance } = await WebAssembly.instantiate(fs.readFileSync(process.argv[2]), {});
const { memory, job_count, job_name, job_name_bytes, job_run } = instance.exports;

for (let index = 0; index < job_count(); index++) {
  const name = new TextDecoder().decode(new Uint8Array(memory.buffer, job_name(index), job_name_bytes(index)));
  const crc = (job_run(index) >>> 0).toString(16).padStart(8, '0');
  console.log(`${name} crc32=${crc}`);
}
