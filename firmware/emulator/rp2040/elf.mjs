// Reads a 32-bit little-endian ELF file: what to load where.

const LOAD = 1;

// [{ address, bytes }] of every loaded segment, at the address it is stored at (flash, for initialised data).
export function segments(file) {
  if (file.readUInt32BE(0) !== 0x7f454c46 || file[4] !== 1 || file[5] !== 1) {
    throw new Error('not a 32-bit little-endian ELF file');
  }
  const first = file.readUInt32LE(28);
  const size = file.readUInt16LE(42);
  const count = file.readUInt16LE(44);
  const found = [];
  for (let header = first; header < first + count * size; header += size) {
    const bytes = file.readUInt32LE(header + 16);
    if (file.readUInt32LE(header) === LOAD && bytes > 0) {
      const offset = file.readUInt32LE(header + 4);
      found.push({ address: file.readUInt32LE(header + 12), bytes: file.subarray(offset, offset + bytes) });
    }
  }
  return found;
}
