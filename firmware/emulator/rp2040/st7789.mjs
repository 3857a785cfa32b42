// An ST7789 display controller behind 4-wire SPI: 240 x 320 pixels of memory, windows, orientation, pixel formats.
//
// ST7789VW datasheet (Sitronix, v1.0), sections 8.8 (memory access), 9.1 (commands).

import fs from 'node:fs';
import { PNG } from 'pngjs';

export const WIDTH = 240;
export const HEIGHT = 320;

const COMMAND = {
  NOP: 0x00, SWRESET: 0x01, SLPIN: 0x10, SLPOUT: 0x11, NORON: 0x13, INVOFF: 0x20, INVON: 0x21, DISPOFF: 0x28,
  DISPON: 0x29, CASET: 0x2a, RASET: 0x2b, RAMWR: 0x2c, VSCRDEF: 0x33, MADCTL: 0x36, VSCSAD: 0x37, COLMOD: 0x3a,
  RAMWRC: 0x3c,
};
const KNOWN = new Set(Object.values(COMMAND));
const MADCTL = { MIRROR_Y: 0x80, MIRROR_X: 0x40, EXCHANGE: 0x20, BGR: 0x08 };

export class St7789 {
  // `onPixel(x, y)`: a place of the memory was written.
  constructor(onPixel) {
    this.onPixel = onPixel;
    // 0xRRGGBB, of 8 bits each however the pixel came.
    this.memory = new Uint32Array(WIDTH * HEIGHT);
    this.unknown = new Set();
    this.pixels = 0;
    this.reset();
  }

  // The memory keeps its contents.
  reset() {
    this.command = COMMAND.NOP;
    this.arguments = [];
    this.access = 0;
    this.format = 0x66;
    this.inverted = false;
    this.on = false;
    this.asleep = true;
    this.columns = [0, WIDTH - 1];
    this.rows = [0, HEIGHT - 1];
    this.column = 0;
    this.row = 0;
  }

  // One byte, with the data/command pin high for data.
  byte(value, isData) {
    if (isData) this.data(value);
    else this.begin(value);
  }

  begin(command) {
    this.command = command;
    this.arguments = [];
    switch (command) {
      case COMMAND.SWRESET: this.reset(); break;
      case COMMAND.SLPIN: this.asleep = true; break;
      case COMMAND.SLPOUT: this.asleep = false; break;
      case COMMAND.INVOFF: this.inverted = false; break;
      case COMMAND.INVON: this.inverted = true; break;
      case COMMAND.DISPOFF: this.on = false; break;
      case COMMAND.DISPON: this.on = true; break;
      case COMMAND.RAMWR: [this.column] = this.columns; [this.row] = this.rows; break;
    }
    if (!KNOWN.has(command)) this.unknown.add(command);
  }

  data(value) {
    this.arguments.push(value);
    const received = this.arguments;
    switch (this.command) {
      case COMMAND.CASET: if (received.length === 4) this.columns = this.range(received); break;
      case COMMAND.RASET: if (received.length === 4) this.rows = this.range(received); break;
      case COMMAND.MADCTL: this.access = value; break;
      case COMMAND.COLMOD: this.format = value; break;
      case COMMAND.RAMWR:
      case COMMAND.RAMWRC: this.pixelData(received); break;
    }
  }

  range([startHigh, startLow, endHigh, endLow]) {
    return [(startHigh << 8) | startLow, (endHigh << 8) | endLow];
  }

  // Takes whole pixels out of `received`: 12, 16 or 18 bits each.
  pixelData(received) {
    switch (this.format & 7) {
      case 3:
        if (received.length < 3) return;
        this.write(widen(received[0] >> 4, 4), widen(received[0] & 15, 4), widen(received[1] >> 4, 4));
        this.write(widen(received[1] & 15, 4), widen(received[2] >> 4, 4), widen(received[2] & 15, 4));
        break;
      case 5: {
        if (received.length < 2) return;
        const pixel = (received[0] << 8) | received[1];
        this.write(widen(pixel >> 11, 5), widen((pixel >> 5) & 63, 6), widen(pixel & 31, 5));
        break;
      }
      case 6:
        if (received.length < 3) return;
        this.write(...received.map((value) => widen(value >> 2, 6)));
        break;
      default: throw new Error(`the display has no pixel format ${this.format.toString(16)}`);
    }
    received.length = 0;
  }

  write(red, green, blue) {
    let x = this.column;
    let y = this.row;
    if (this.access & MADCTL.EXCHANGE) [x, y] = [y, x];
    if (this.access & MADCTL.MIRROR_X) x = WIDTH - 1 - x;
    if (this.access & MADCTL.MIRROR_Y) y = HEIGHT - 1 - y;
    if (x >= 0 && x < WIDTH && y >= 0 && y < HEIGHT) {
      if (this.access & MADCTL.BGR) [red, blue] = [blue, red];
      this.memory[y * WIDTH + x] = (red << 16) | (green << 8) | blue;
      this.pixels++;
      this.onPixel(x, y);
    }
    if (this.column++ === this.columns[1]) {
      [this.column] = this.columns;
      if (this.row++ === this.rows[1]) [this.row] = this.rows;
    }
  }

  // What an eye sees at a place of the panel. An IPS panel shows true colours when inversion is on.
  visible(x, y) {
    if (!this.on || this.asleep) return 0;
    const colour = this.memory[y * WIDTH + x];
    return this.inverted ? colour : ~colour & 0xffffff;
  }

  // `width` x `height` colours of a panel that shows the memory from its corner on, held turned by 0 or 90 degrees.
  view({ width, height, turned }) {
    const colours = new Uint32Array(width * height);
    for (let y = 0; y < height; y++) {
      for (let x = 0; x < width; x++) {
        colours[y * width + x] = turned ? this.visible(WIDTH - 1 - y, x) : this.visible(x, y);
      }
    }
    return colours;
  }
}

// `bits` bits to 8, the highest repeated below: 0 stays black and the largest becomes 255.
function widen(value, bits) {
  const shifted = value << (8 - bits);
  return shifted | (shifted >> bits);
}

export function writePng(file, colours, { width, height }) {
  const image = new PNG({ width, height, colorType: 2 });
  colours.forEach((colour, index) => {
    image.data.writeUInt32BE(((colour << 8) | 0xff) >>> 0, 4 * index);
  });
  fs.writeFileSync(file, PNG.sync.write(image));
}
