// node run.mjs FIRMWARE.elf [options]: runs RP2040 firmware with an ST7789 on SPI0 until it exits or has drawn enough.
//
//   --png FILE      what the display shows at the end
//   --rgb FILE      the same as bare bytes: red, green, blue of each pixel, row by row
//   --each FILE     those bytes at each line of the firmware's that begins with "frame ", one after the other
//   --json FILE     times, cycles, stacks, faults
//   --size WxH      240x240 (default), 240x320 or 320x240, the panel turned by 90 degrees
//   --frames N      end after N whole frames (default: at the firmware's end)
//   --until TEXT    end when the firmware has printed a line that starts so
//   --after MS      go on so long, emulated, behind such an end
//   --seconds S     emulated time after which to give up (default 60)
//   --quiet         no progress and no summary on standard error
//
// Standard output is what the firmware prints, by UART0 or semihosting. Exit status: the firmware's; 124 out of time.
// Display: CS GPIO17, SCK GPIO18, MOSI GPIO19, D/C GPIO20, RST GPIO21.

import fs from 'node:fs';
import { parseArgs } from 'node:util';
import { GPIOPinState } from 'rp2040js';
import { Chip } from './chip.mjs';
import { segments } from './elf.mjs';
import { HEIGHT, St7789, WIDTH, writePng } from './st7789.mjs';

const PINS = { select: 17, data: 20, reset: 21 };
const OUT_OF_TIME = 124;
const SIZES = {
  '240x240': { width: 240, height: 240, turned: false },
  '240x320': { width: 240, height: 320, turned: false },
  '320x240': { width: 320, height: 240, turned: true },
};

const { values: options, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    png: { type: 'string' },
    rgb: { type: 'string' },
    each: { type: 'string' },
    json: { type: 'string' },
    size: { type: 'string', default: '240x240' },
    frames: { type: 'string', default: '0' },
    until: { type: 'string' },
    after: { type: 'string', default: '0' },
    seconds: { type: 'string', default: '60' },
    quiet: { type: 'boolean', default: false },
  },
});
const size = SIZES[options.size];
if (positionals.length !== 1 || !size) {
  console.error('usage: node run.mjs FIRMWARE.elf [--png FILE] [--size 240x240|240x320|320x240] ...');
  process.exit(2);
}

// Which places of the memory the panel shows, and which of them the frame at hand has written.
const panel = size.turned ? { width: size.height, height: size.width } : size;
const written = new Uint8Array(WIDTH * HEIGHT);
let left = panel.width * panel.height;
const frames = [];
let firstPixel = null;
let lastPixel = null;
let lostBytes = 0;

const each = options.each ? fs.openSync(options.each, 'w') : null;

// Red, green, blue of each pixel, as the display shows it.
function colours() {
  const seen = display.view(size);
  const bytes = Buffer.alloc(3 * seen.length);
  seen.forEach((colour, index) => bytes.writeUIntBE(colour, 3 * index, 3));
  return bytes;
}

const status = { code: null, line: '', end: Infinity };
const faults = [];
let resets = 0;

const milliseconds = () => chip.clock.nanos / 1e6;

function finish() {
  status.end = Math.min(status.end, milliseconds() + Number(options.after));
}

const events = {
  text(text) {
    process.stdout.write(text);
    const lines = (status.line + text).split('\n');
    status.line = lines.pop();
    if (each !== null) lines.filter((line) => line.startsWith('frame ')).forEach(() => fs.writeSync(each, colours()));
    if (options.until && lines.some((line) => line.startsWith(options.until))) finish();
  },
  warn(message) {
    console.error(`warning: ${message}`);
  },
  fault(core, reason, address) {
    faults.push({ core, reason, address: `0x${address.toString(16)}`, ms: milliseconds() });
    console.error(`core ${core} faults at 0x${address.toString(16)}: ${reason}`);
  },
  reset() {
    resets++;
    console.error(`watchdog reset at ${milliseconds().toFixed(3)} ms`);
  },
  exit(code) {
    status.code ??= code;
  },
};

const chip = new Chip(events);
const display = new St7789((x, y) => {
  firstPixel ??= milliseconds();
  lastPixel = milliseconds();
  if (x >= panel.width || y >= panel.height || written[y * WIDTH + x]) return;
  written[y * WIDTH + x] = 1;
  if (--left > 0) return;
  frames.push(milliseconds());
  written.fill(0);
  left = panel.width * panel.height;
  if (frames.length === Number(options.frames)) finish();
});
const isHigh = (pin) => chip.gpio[pin].value === GPIOPinState.High;
chip.gpio[PINS.reset].addListener((state) => state === GPIOPinState.Low && display.reset());
chip.connectSpi(0, (word, bits) => {
  if (isHigh(PINS.select)) {
    lostBytes++;
    return;
  }
  if (bits > 8) display.byte(word >> 8, isHigh(PINS.data));
  display.byte(word & 255, isHigh(PINS.data));
});
chip.load(segments(fs.readFileSync(positionals[0])));

const start = process.hrtime.bigint();
const hostSeconds = () => Number(process.hrtime.bigint() - start) / 1e9;
let shown = 0;
const limit = 1e3 * Number(options.seconds);
while (status.code === null && milliseconds() < limit) {
  for (let steps = 0; steps < 2000 && status.code === null; steps++) {
    chip.step();
    if (milliseconds() >= status.end) status.code = 0;
  }
  if (!options.quiet && hostSeconds() - shown > 0.5) {
    shown = hostSeconds();
    const share = (100 * (1 - left / (panel.width * panel.height))).toFixed(0);
    const speed = (milliseconds() / 1e3 / shown).toFixed(2);
    process.stderr.write(`\r${milliseconds().toFixed(0)} ms, frame ${frames.length + 1}: ${share} %, ${speed} of real time `);
  }
}
if (!options.quiet) process.stderr.write('\r\x1b[K');
status.code ??= OUT_OF_TIME;

const stack = (core) => (core.initialStack ? core.initialStack - core.lowestStack : 0);
const report = {
  exit: status.code,
  clock_hz: chip.clkSys,
  ms: milliseconds(),
  first_pixel_ms: firstPixel,
  last_pixel_ms: lastPixel,
  frame_ms: frames,
  pixels: display.pixels,
  lost_bytes: lostBytes,
  unknown_commands: [...display.unknown],
  cycles: Math.round(chip.cores[0].cycles),
  instructions: chip.cores.map((core) => core.instructions),
  stack_bytes: chip.cores.map(stack),
  faults,
  locked_up: chip.lockedUp,
  resets,
  host_seconds: hostSeconds(),
};
if (options.png) writePng(options.png, display.view(size), size);
if (options.rgb) fs.writeFileSync(options.rgb, colours());
if (options.json) fs.writeFileSync(options.json, `${JSON.stringify(report, null, 2)}\n`);
if (!options.quiet) summarise();

function summarise() {
  const ms = (time) => (time === null ? 'never' : `${time.toFixed(2)} ms`);
  const mhz = (report.clock_hz / 1e6).toFixed(0);
  const instructions = report.instructions[0] + report.instructions[1];
  const speed = (instructions / report.host_seconds / 1e6).toFixed(1);
  console.error(`first pixel ${ms(firstPixel)}, whole frames ${frames.map(ms).join(', ') || 'none'}, end ${ms(report.ms)}`);
  console.error(`${mhz} MHz, ${report.cycles} cycles, instructions ${report.instructions.join(' + ')}`);
  console.error(`deepest stacks ${report.stack_bytes.join(' + ')} bytes`);
  if (lostBytes > 0) console.error(`${lostBytes} bytes were sent while the display was not selected`);
  if (display.unknown.size > 0) console.error(`unknown display commands: ${report.unknown_commands.join(', ')}`);
  if (status.code === OUT_OF_TIME) console.error(`not done after ${options.seconds} s`);
  console.error(`emulated in ${report.host_seconds.toFixed(2)} s, ${speed} million instructions a second`);
}
process.exitCode = status.code;
