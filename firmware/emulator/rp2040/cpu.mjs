// A Cortex-M0+ that computes flags as the manual says, and quickly.
//
// rp2040js 1.4.1 sets carry and overflow wrongly in ADCS, SBCS and the shifts by register, and decodes each instruction
// by a chain of comparisons. This core decodes through a table and executes the common instructions itself; system
// instructions, exceptions, LDM, STM, POP and jumps through registers stay with the base class.
//
// Cycles: Cortex-M0+ Technical Reference Manual, table 3-1, memory without wait states; PUSH counts LR. It has the same
// costs as the counting plugin for QEMU, plus those of the buses to peripherals.

import fs from 'node:fs';
import { RP2040 } from 'rp2040js';

const WRITTEN_FOR = '1.4.1';
const { version } = JSON.parse(fs.readFileSync(new URL('./node_modules/rp2040js/package.json', import.meta.url)));
if (version !== WRITTEN_FOR) {
  throw new Error(`rp2040js ${version} is installed; this emulator is written for ${WRITTEN_FOR}: run npm ci`);
}

const FLASH = 0x10;
const RAM = 0x20;

const KINDS = [
  'other',
  'lslImmediate', 'lsrImmediate', 'asrImmediate',
  'addRegister', 'subRegister', 'addShort', 'subShort',
  'movImmediate', 'cmpImmediate', 'addImmediate', 'subImmediate',
  'and', 'eor', 'lsl', 'lsr', 'asr', 'adc', 'sbc', 'ror', 'tst', 'rsb', 'cmp', 'cmn', 'orr', 'mul', 'bic', 'mvn',
  'addHigh', 'cmpHigh', 'movHigh',
  'loadLiteral', 'storeRegister', 'loadRegister', 'storeWord', 'loadWord', 'storeByte', 'loadByte', 'storeHalf',
  'loadHalf', 'storeStack', 'loadStack', 'addressOfLiteral', 'addressInStack', 'moveStack', 'extend', 'push',
  'branchIf', 'branch', 'call',
];
const K = Object.fromEntries(KINDS.map((kind, number) => [kind, number]));

function kindOf(opcode) {
  const top = opcode >> 11;
  switch (top) {
    case 0b00000: return K.lslImmediate;
    case 0b00001: return K.lsrImmediate;
    case 0b00010: return K.asrImmediate;
    case 0b00011: return [K.addRegister, K.subRegister, K.addShort, K.subShort][(opcode >> 9) & 3];
    case 0b00100: return K.movImmediate;
    case 0b00101: return K.cmpImmediate;
    case 0b00110: return K.addImmediate;
    case 0b00111: return K.subImmediate;
    case 0b01001: return K.loadLiteral;
    case 0b01100: return K.storeWord;
    case 0b01101: return K.loadWord;
    case 0b01110: return K.storeByte;
    case 0b01111: return K.loadByte;
    case 0b10000: return K.storeHalf;
    case 0b10001: return K.loadHalf;
    case 0b10010: return K.storeStack;
    case 0b10011: return K.loadStack;
    case 0b10100: return K.addressOfLiteral;
    case 0b10101: return K.addressInStack;
    case 0b11100: return K.branch;
    case 0b11110: return K.call; // or a system instruction: the second half decides
  }
  if (opcode >> 10 === 0b010000) return K.and + ((opcode >> 6) & 15);
  if (opcode >> 10 === 0b010001) {
    const destination = ((opcode >> 4) & 8) | (opcode & 7);
    // Jumps, and moves to the stack pointer, which drop bits, are for the base class.
    return destination >= 13 ? K.other : [K.addHigh, K.cmpHigh, K.movHigh, K.other][(opcode >> 8) & 3];
  }
  if (opcode >> 12 === 0b0101) return ((opcode >> 9) & 7) < 3 ? K.storeRegister : K.loadRegister;
  if (opcode >> 8 === 0b10110000) return K.moveStack;
  if (opcode >> 8 === 0b10110010) return K.extend;
  if (opcode >> 9 === 0b1011010) return K.push;
  if (opcode >> 12 === 0b1101 && ((opcode >> 8) & 15) < 14) return K.branchIf;
  return K.other;
}

const DECODED = Uint8Array.from({ length: 0x10000 }, (_, opcode) => kindOf(opcode));

const Base = new RP2040().core.constructor;

export class Core extends Base {
  constructor(chip) {
    super(chip);
    const { flash, sram } = chip;
    this.flash = new DataView(flash.buffer);
    this.flash16 = new Uint16Array(flash.buffer);
    this.sram = new DataView(sram.buffer);
    this.sram16 = new Uint16Array(sram.buffer);
    this.sramBytes = sram.length;
    this.flashBytes = flash.length;
    // Bytes that the memory protection unit keeps the stack out of.
    this.guardStart = 0;
    this.guardEnd = 0;
    this.instructions = 0;
    this.lowestStack = 0xffffffff;
  }

  // Returns the cycles it took.
  executeInstruction() {
    if (this.interruptsUpdated && this.checkForInterrupts()) this.waiting = false;
    this.instructions++;
    const registers = this.registers;
    const pc = registers[15];
    const offset = (pc & 0xffffff) >> 1;
    let opcode;
    if (pc >>> 24 === FLASH) opcode = this.flash16[offset];
    else if (pc >>> 24 === RAM) opcode = this.sram16[offset];
    else return super.executeInstruction();

    let cycles = 1;
    const d = opcode & 7;
    const m = (opcode >> 3) & 7;
    const short = (opcode >> 6) & 31;
    const immediate = opcode & 255;
    const d8 = (opcode >> 8) & 7;
    registers[15] = pc + 2;
    switch (DECODED[opcode]) {
      case K.lslImmediate: this.shiftLeft(d, registers[m], short); break;
      case K.lsrImmediate: this.shiftRight(d, registers[m], short || 32); break;
      case K.asrImmediate: this.shiftArithmetic(d, registers[m], short || 32); break;
      case K.addRegister: registers[d] = this.add(registers[m], registers[short & 7], 0); break;
      case K.subRegister: registers[d] = this.add(registers[m], ~registers[short & 7], 1); break;
      case K.addShort: registers[d] = this.add(registers[m], short & 7, 0); break;
      case K.subShort: registers[d] = this.add(registers[m], ~(short & 7), 1); break;
      case K.movImmediate: this.logic(registers[d8] = immediate); break;
      case K.cmpImmediate: this.add(registers[d8], ~immediate, 1); break;
      case K.addImmediate: registers[d8] = this.add(registers[d8], immediate, 0); break;
      case K.subImmediate: registers[d8] = this.add(registers[d8], ~immediate, 1); break;

      case K.and: this.logic(registers[d] = registers[d] & registers[m]); break;
      case K.eor: this.logic(registers[d] = registers[d] ^ registers[m]); break;
      case K.lsl: this.shiftLeft(d, registers[d], registers[m] & 255); break;
      case K.lsr: this.shiftRight(d, registers[d], registers[m] & 255); break;
      case K.asr: this.shiftArithmetic(d, registers[d], registers[m] & 255); break;
      case K.adc: registers[d] = this.add(registers[d], registers[m], this.C ? 1 : 0); break;
      case K.sbc: registers[d] = this.add(registers[d], ~registers[m], this.C ? 1 : 0); break;
      case K.ror: this.rotate(d, registers[d], registers[m] & 255); break;
      case K.tst: this.logic(registers[d] & registers[m]); break;
      case K.rsb: registers[d] = this.add(~registers[m], 0, 1); break;
      case K.cmp: this.add(registers[d], ~registers[m], 1); break;
      case K.cmn: this.add(registers[d], registers[m], 0); break;
      case K.orr: this.logic(registers[d] = registers[d] | registers[m]); break;
      case K.mul: this.logic(registers[d] = Math.imul(registers[d], registers[m])); break;
      case K.bic: this.logic(registers[d] = registers[d] & ~registers[m]); break;
      case K.mvn: this.logic(registers[d] = ~registers[m]); break;

      case K.addHigh: {
        const target = ((opcode >> 4) & 8) | d;
        registers[target] = registers[target] + this.operand(opcode);
        break;
      }
      case K.cmpHigh: this.add(registers[((opcode >> 4) & 8) | d], ~this.operand(opcode), 1); break;
      case K.movHigh: registers[((opcode >> 4) & 8) | d] = this.operand(opcode); break;

      case K.loadLiteral: cycles += this.load(((pc + 4) & ~3) + 4 * immediate, d8, 4); break;
      case K.loadWord: cycles += this.load(registers[m] + 4 * short, d, 4); break;
      case K.loadHalf: cycles += this.load(registers[m] + 2 * short, d, 2); break;
      case K.loadByte: cycles += this.load(registers[m] + short, d, 1); break;
      case K.loadStack: cycles += this.load(registers[13] + 4 * immediate, d8, 4); break;
      case K.loadRegister: {
        const address = registers[m] + registers[short & 7];
        switch ((opcode >> 9) & 7) {
          case 3: cycles += this.load(address, d, 1); registers[d] = (registers[d] << 24) >> 24; break;
          case 4: cycles += this.load(address, d, 4); break;
          case 5: cycles += this.load(address, d, 2); break;
          case 6: cycles += this.load(address, d, 1); break;
          case 7: cycles += this.load(address, d, 2); registers[d] = (registers[d] << 16) >> 16; break;
        }
        break;
      }
      case K.storeWord: cycles += this.store(registers[m] + 4 * short, registers[d], 4); break;
      case K.storeHalf: cycles += this.store(registers[m] + 2 * short, registers[d], 2); break;
      case K.storeByte: cycles += this.store(registers[m] + short, registers[d], 1); break;
      case K.storeRegister: {
        const bytes = [4, 2, 1][(opcode >> 9) & 7];
        cycles += this.store(registers[m] + registers[short & 7], registers[d], bytes);
        break;
      }
      case K.storeStack: {
        const address = registers[13] + 4 * immediate;
        if (this.isGuarded(address)) this.rp2040.fault('store into the guard below the stack');
        else cycles += this.store(address, registers[d8], 4);
        break;
      }
      case K.addressOfLiteral: registers[d8] = ((pc + 4) & ~3) + 4 * immediate; break;
      case K.addressInStack: registers[d8] = registers[13] + 4 * immediate; break;
      case K.moveStack: {
        const bytes = 4 * (opcode & 127);
        this.setStack(registers[13] + (opcode & 128 ? -bytes : bytes));
        break;
      }
      case K.extend:
        switch ((opcode >> 6) & 3) {
          case 0: registers[d] = (registers[m] << 16) >> 16; break;
          case 1: registers[d] = (registers[m] << 24) >> 24; break;
          case 2: registers[d] = registers[m] & 0xffff; break;
          case 3: registers[d] = registers[m] & 0xff; break;
        }
        break;
      case K.push: cycles += this.push(opcode & 0x1ff); break;

      case K.branchIf:
        if (this.checkCondition((opcode >> 8) & 15)) {
          registers[15] = pc + 4 + ((opcode << 24) >> 23);
          cycles = 2;
        }
        break;
      case K.branch:
        registers[15] = pc + 4 + ((opcode << 21) >> 20);
        cycles = 2;
        break;
      case K.call: {
        const second = pc >>> 24 === FLASH ? this.flash16[offset + 1] : this.sram16[offset + 1];
        if (second >> 14 !== 3 || (second & 0x1000) === 0) {
          registers[15] = pc;
          return super.executeInstruction();
        }
        registers[14] = (pc + 4) | 1;
        registers[15] = pc + 4 + callDistance(opcode, second);
        cycles = 3;
        break;
      }
      default:
        registers[15] = pc;
        return super.executeInstruction();
    }
    this.cycles += cycles;
    return cycles;
  }

  // The vector's lowest bit is the instruction set, not part of the address.
  exceptionEntry(number) {
    super.exceptionEntry(number);
    this.registers[15] &= ~1;
  }

  operand(opcode) {
    const number = (opcode >> 3) & 15;
    // The program counter reads 4 ahead, and is 2 ahead already.
    return this.registers[number] + (number === 15 ? 2 : 0);
  }

  add(a, b, carry) {
    const x = a >>> 0;
    const y = b >>> 0;
    const sum = x + y + carry;
    const result = sum | 0;
    this.N = result < 0;
    this.Z = result === 0;
    this.C = sum > 0xffffffff;
    this.V = (~(x ^ y) & (x ^ result)) < 0;
    return result;
  }

  // N and Z; C and V stay.
  logic(result) {
    this.N = (result | 0) < 0;
    this.Z = result === 0;
  }

  shiftLeft(d, value, places) {
    if (places > 0) this.C = places <= 32 && ((value >>> (32 - places)) & 1) !== 0;
    this.logic(this.registers[d] = places < 32 ? value << places : 0);
  }

  shiftRight(d, value, places) {
    if (places > 0) this.C = places <= 32 && ((value >>> (places - 1)) & 1) !== 0;
    this.logic(this.registers[d] = places < 32 ? value >>> places : 0);
  }

  shiftArithmetic(d, value, places) {
    if (places > 0) this.C = ((value >> Math.min(places - 1, 31)) & 1) !== 0;
    this.logic(this.registers[d] = value >> Math.min(places, 31));
  }

  rotate(d, value, places) {
    const result = (value >>> (places & 31)) | (value << (-places & 31));
    if (places > 0) this.C = result < 0;
    this.logic(this.registers[d] = result);
  }

  // Cycles beyond the first.
  load(address, d, bytes) {
    address >>>= 0;
    const region = address >>> 24;
    const offset = address & 0xffffff;
    let view;
    if (region === RAM && offset + bytes <= this.sramBytes) view = this.sram;
    else if (region === FLASH && offset + bytes <= this.flashBytes) view = this.flash;
    if ((address & (bytes - 1)) !== 0) {
      this.rp2040.fault(`unaligned load from ${address.toString(16)}`);
    } else if (view) {
      switch (bytes) {
        case 4: this.registers[d] = view.getUint32(offset, true); break;
        case 2: this.registers[d] = view.getUint16(offset, true); break;
        default: this.registers[d] = view.getUint8(offset);
      }
    } else {
      const cycles = this.cyclesIO(address);
      switch (bytes) {
        case 4: this.registers[d] = this.readUint32(address); break;
        case 2: this.registers[d] = this.readUint16(address); break;
        default: this.registers[d] = this.readUint8(address);
      }
      return cycles;
    }
    return 1;
  }

  store(address, value, bytes) {
    address >>>= 0;
    const offset = address & 0xffffff;
    if ((address & (bytes - 1)) !== 0) {
      this.rp2040.fault(`unaligned store to ${address.toString(16)}`);
    } else if (address >>> 24 === RAM && offset + bytes <= this.sramBytes) {
      switch (bytes) {
        case 4: this.sram.setUint32(offset, value, true); break;
        case 2: this.sram.setUint16(offset, value, true); break;
        default: this.sram.setUint8(offset, value);
      }
    } else {
      const cycles = this.cyclesIO(address, true);
      switch (bytes) {
        case 4: this.writeUint32(address, value); break;
        case 2: this.writeUint16(address, value); break;
        default: this.writeUint8(address, value);
      }
      return cycles;
    }
    return 1;
  }

  setStack(address) {
    this.registers[13] = address;
    if (this.registers[13] < this.lowestStack) this.lowestStack = this.registers[13];
  }

  isGuarded(address) {
    return address >= this.guardStart && address < this.guardEnd;
  }

  push(list) {
    const registers = this.registers;
    let address = registers[13];
    for (let number = 8; number >= 0; number--) {
      if (list & (1 << number)) {
        address -= 4;
        if (this.isGuarded(address)) {
          this.rp2040.fault('push into the guard below the stack');
          return 1;
        }
        this.store(address, registers[number === 8 ? 14 : number], 4);
      }
    }
    const words = (registers[13] - address) / 4;
    this.setStack(address);
    return words;
  }
}

// Signed distance of BL from its two halves.
function callDistance(first, second) {
  const sign = (first >> 10) & 1;
  const i1 = ~((second >> 13) ^ sign) & 1;
  const i2 = ~((second >> 11) ^ sign) & 1;
  const bits = (sign << 24) | (i1 << 23) | (i2 << 22) | ((first & 0x3ff) << 12) | ((second & 0x7ff) << 1);
  return (bits << 7) >> 7;
}
