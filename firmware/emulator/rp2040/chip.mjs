// An RP2040 with two cores, on top of rp2040js, which has one.
//
// Added here: core 1 with its FIFOs and start-up handshake, a divider for each core that takes no more time than the
// firmware waits for, faults on wrong addresses, the stack guard of the memory protection unit, cores held by the power
// state machine, the watchdog's reset, and SPI that takes time. Not modelled: cache misses of the flash, contention
// for the memory banks, interrupts on core 1, core 1's interpolators, the duration of UART output.

import { RP2040 } from 'rp2040js';
import { Core } from './cpu.mjs';
import * as rom from './rom.mjs';

const HARD_FAULT = 3;
const VECTORS = 0x10000100;
// Cycles that one core may run ahead of the other.
const QUANTUM = 32;

const SIO = { CPUID: 0x00, FIFO_STATUS: 0x50, FIFO_WRITE: 0x54, FIFO_READ: 0x58 };
const FIFO_DEPTH = 8;
const MPU = { TYPE: 0xd90, CONTROL: 0xd94, NUMBER: 0xd98, BASE: 0xd9c, SIZE: 0xda0 };
// rp2040js does not know it, and no DMA feeds a UART here.
const UART_DMA_CONTROL = 0x48;
const WATCHDOG = { offset: 0x40058, CONTROL: 0 };
const PSM = { offset: 0x40010, FORCE_OFF: 0x04, CORES: [1 << 15, 1 << 16] };

export class Chip extends RP2040 {
  // `events`: { text(string), fault(core, reason, address), reset(), exit(code) }
  constructor(events) {
    super();
    this.events = events;
    this.cores = [new Core(this), new Core(this)];
    this.running = 0;
    this.core = this.cores[0];
    this.held = [false, true];
    this.lockedUp = [false, false];
    this.pending = null;
    this.reboots = false;
    // Something happened that ends the current quantum.
    this.interrupted = false;
    this.entry = VECTORS;
    this.fifos = [[], []];
    this.fifoErrors = [0, 0];
    this.handshake = [];
    this.otherDivider = { divDividend: 0, divDivisor: 0, divQuotient: 0, divRemainder: 0, divCSR: 0 };
    this.mpu = [{}, {}];
    this.logger = {
      debug() {},
      info: (_, message) => message === 'SEV' && this.wake(),
      warn: (name, message) => this.complain(name, message),
      error: (name, message) => this.complain(name, message),
    };
    rom.install(this);
    this.adaptSio();
    this.adaptMpu();
    this.adaptPowerAndWatchdog();
    this.onBreak = (number) => this.breakpoint(number);
    for (const uart of this.uart) {
      const write = uart.writeUint32.bind(uart);
      uart.writeUint32 = (offset, value) => offset !== UART_DMA_CONTROL && write(offset, value);
    }
    this.uart[0].onByte = (byte) => events.text(String.fromCharCode(byte));
  }

  load(segments) {
    for (const { address, bytes } of segments) {
      if (address >>> 24 === 0x10) this.flash.set(bytes, address & 0xffffff);
      else throw new Error(`a segment at ${address.toString(16)} does not lie in flash`);
    }
    this.restart();
  }

  // Power-on, past the boot ROM and the second-stage loader.
  restart() {
    this.select(0);
    const [first, second] = this.cores;
    first.VTOR = this.entry;
    first.SP = this.readUint32(this.entry);
    first.PC = this.readUint32(this.entry + 4) & ~1;
    first.IPSR = 0;
    first.currentMode = 0;
    first.PM = false;
    first.waiting = false;
    second.waiting = false;
    first.initialStack = first.SP;
    this.held = [false, true];
    this.lockedUp = [false, false];
    this.handshake = [];
    this.fifos = [[], []];
    this.mpu = [{}, {}];
    for (const core of this.cores) core.guardStart = core.guardEnd = 0;
  }

  complain(name, message) {
    if (/invalid memory|undefined address|not 32 bit aligned|is not implemented/.test(message)) this.fault(message);
    else if (!/Opcode:/.test(message)) this.events.warn(`${name}: ${message}`);
  }

  // Remembers a fault of the current instruction; `raise` takes it when the instruction is over.
  fault(reason) {
    this.pending ??= reason;
  }

  raise(core, address) {
    const reason = this.pending;
    this.events.fault(this.running, reason, address);
    if (core.IPSR === HARD_FAULT) {
      this.lockedUp[this.running] = true;
      this.interrupted = true;
    } else {
      core.PC = address;
      core.exceptionEntry(HARD_FAULT);
    }
    // Writing the frame to a bad stack is no further fault: the handler runs, with that stack pointer.
    this.pending = null;
  }

  breakpoint(number) {
    const { core } = this;
    const opcode = this.readUint16(core.PC - 2);
    if (opcode >> 8 !== 0xbe) this.fault('undefined instruction');
    else if (number === 0xab) this.semihosting();
    else if (!rom.serve(this, core, number)) this.fault(`breakpoint ${number}`);
  }

  // The calls that print and exit.
  semihosting() {
    const { registers } = this.core;
    const [operation, argument] = registers;
    const word = (index) => this.readUint32(argument + 4 * index);
    switch (operation) {
      case 0x01: // SYS_OPEN, of the console
        registers[0] = 1;
        break;
      case 0x02: // SYS_CLOSE
        registers[0] = 0;
        break;
      case 0x05: { // SYS_WRITE
        let text = '';
        for (let at = 0; at < word(2); at++) text += String.fromCharCode(this.readUint8(word(1) + at));
        this.events.text(text);
        registers[0] = 0;
        break;
      }
      case 0x18: // SYS_EXIT
        this.exit(argument === 0x20026 ? 0 : 1);
        break;
      case 0x20: // SYS_EXIT_EXTENDED
        this.exit(word(1));
        break;
      default:
        this.fault(`semihosting operation ${operation}`);
    }
  }

  exit(code) {
    this.interrupted = true;
    this.events.exit(code);
  }

  // Makes the registers that each core has for itself those of core `number`.
  select(number) {
    if (number === this.running) return;
    const { sio } = this;
    const { divDividend, divDivisor, divQuotient, divRemainder, divCSR } = sio;
    const other = this.otherDivider;
    sio.divDividend = other.divDividend;
    sio.divDivisor = other.divDivisor;
    sio.divQuotient = other.divQuotient;
    sio.divRemainder = other.divRemainder;
    sio.divCSR = other.divCSR;
    other.divDividend = divDividend;
    other.divDivisor = divDivisor;
    other.divQuotient = divQuotient;
    other.divRemainder = divRemainder;
    other.divCSR = divCSR;
    this.running = number;
    this.core = this.cores[number];
  }

  wake() {
    for (const core of this.cores) {
      core.eventRegistered = true;
      core.waiting = false;
    }
  }

  adaptSio() {
    const { sio } = this;
    const read = sio.readUint32.bind(sio);
    const write = sio.writeUint32.bind(sio);
    sio.readUint32 = (offset) => {
      const own = this.fifos[this.running];
      switch (offset) {
        case SIO.CPUID: return this.running;
        case SIO.FIFO_STATUS: {
          const room = this.fifos[1 - this.running].length < FIFO_DEPTH;
          return (own.length > 0 ? 1 : 0) | (room ? 2 : 0) | this.fifoErrors[this.running];
        }
        case SIO.FIFO_READ:
          if (own.length > 0) return own.shift();
          this.fifoErrors[this.running] |= 8;
          return 0;
        default: return read(offset);
      }
    };
    sio.writeUint32 = (offset, value) => {
      switch (offset) {
        case SIO.FIFO_STATUS:
          this.fifoErrors[this.running] = 0;
          break;
        case SIO.FIFO_WRITE:
          if (this.running === 0 && this.held[1]) this.launch(value >>> 0);
          else if (this.fifos[1 - this.running].length < FIFO_DEPTH) this.fifos[1 - this.running].push(value >>> 0);
          else this.fifoErrors[this.running] |= 4;
          break;
        default: write(offset, value);
      }
    };
    sio.updateHardwareDivider = (signed) => divide(sio, signed);
  }

  // Core 1's side of its start: 0, 0, 1, vectors, stack, entry, each echoed; out of order starts again.
  launch(value) {
    const step = this.handshake.length;
    const expected = [0, 0, 1][step];
    this.fifos[0].push(value);
    if (expected !== undefined && value !== expected) {
      this.handshake = value === 0 ? [0] : [];
      return;
    }
    this.handshake.push(value);
    if (step < 5) return;
    const core = this.cores[1];
    [, , , core.VTOR, core.SP] = this.handshake;
    core.PC = value & ~1;
    core.initialStack = core.lowestStack = core.SP;
    core.cycles = this.cores[0].cycles;
    core.IPSR = 0;
    core.waiting = false;
    this.handshake = [];
    this.held[1] = false;
  }

  // One region without access, which is how a stack guard looks; read back as written.
  adaptMpu() {
    const { ppb } = this;
    const read = ppb.readUint32.bind(ppb);
    const write = ppb.writeUint32.bind(ppb);
    const isMpu = (offset) => offset >= MPU.TYPE && offset <= MPU.SIZE;
    ppb.readUint32 = (offset) => {
      if (!isMpu(offset)) return read(offset);
      return offset === MPU.TYPE ? 0x800 : (this.mpu[this.running][offset] ?? 0);
    };
    ppb.writeUint32 = (offset, value) => {
      if (!isMpu(offset)) return write(offset, value);
      const registers = this.mpu[this.running];
      registers[offset] = value;
      const size = registers[MPU.SIZE] ?? 0;
      const enabled = (registers[MPU.CONTROL] & 1) !== 0 && (size & 1) !== 0 && ((size >> 24) & 7) === 0;
      const { core } = this;
      core.guardStart = core.guardEnd = 0;
      if (!enabled) return;
      // Eight subregions, each switched off by a bit; a guard leaves a run of them on.
      const bytes = 2 ** (((size >> 1) & 31) + 1);
      const on = [...Array(8).keys()].filter((part) => ((size >> (8 + part)) & 1) === 0);
      const base = (registers[MPU.BASE] & ~(bytes - 1)) >>> 0;
      core.guardStart = base + (on[0] * bytes) / 8;
      core.guardEnd = base + ((on.at(-1) + 1) * bytes) / 8;
    };
  }

  adaptPowerAndWatchdog() {
    const power = this.peripherals[PSM.offset];
    const write = power.writeUint32.bind(power);
    power.writeUint32 = (offset, value) => {
      write(offset, value);
      if (offset !== PSM.FORCE_OFF) return;
      PSM.CORES.forEach((bit, number) => {
        if (value & bit) {
          this.held[number] = true;
          this.interrupted = true;
          this.lockedUp[number] = false;
          if (number === 1) this.handshake = [];
        }
      });
    };
    const watchdog = this.peripherals[WATCHDOG.offset];
    watchdog.onWatchdogTrigger = () => {
      // The reset switches it off; the reason stays.
      watchdog.writeUint32(WATCHDOG.CONTROL, 0);
      this.reboots = true;
      this.interrupted = true;
    };
  }

  isIdle(number) {
    return this.held[number] || this.lockedUp[number] || this.cores[number].waiting;
  }

  // Runs both cores for a little while: until the clock has moved by at least a quantum.
  step() {
    const { clock } = this;
    const first = this.cores[0];
    const second = this.cores[1];
    this.interrupted = false;
    const nanos = 1e9 / this.clkSys;
    if (this.isIdle(0) && this.isIdle(1)) {
      // Nothing happens before the next alarm.
      const wait = clock.nextAlarm ? clock.nanosToNextAlarm : nanos * QUANTUM;
      clock.tick(wait);
      first.cycles += wait / nanos;
      second.cycles = first.cycles;
    } else if (this.isIdle(0)) {
      clock.tick(nanos * QUANTUM);
      first.cycles += QUANTUM;
    } else {
      this.run(first, first.cycles + QUANTUM, nanos);
    }
    if (this.isIdle(1)) {
      second.cycles = first.cycles;
    } else {
      this.select(1);
      this.run(second, first.cycles, 0);
      this.select(0);
    }
    if (this.reboots) {
      this.reboots = false;
      this.events.reset();
      this.restart();
    }
  }

  // Runs the selected core up to `goal` cycles; the clock follows by `nanos` a cycle.
  run(core, goal, nanos) {
    const { clock } = this;
    while (core.cycles < goal && !core.waiting && !this.interrupted) {
      const before = core.cycles;
      const address = core.PC;
      core.executeInstruction();
      if (this.pending !== null) this.raise(core, address);
      if (nanos > 0) {
        clock.nanosCounter += (core.cycles - before) * nanos;
        if (clock.nextAlarm !== null && clock.nextAlarm.nanos <= clock.nanosCounter) clock.tick(0);
      }
    }
  }

  // Delivers what leaves SPI port `number` to `receive(word, bits)` when its last bit is out.
  connectSpi(number, receive) {
    const spi = this.spi[number];
    let word = 0;
    const done = this.clock.createAlarm(() => {
      receive(word, spi.dataBits);
      spi.completeTransmit(0);
    });
    spi.onTransmit = (value) => {
      word = value;
      done.schedule((1e9 * spi.dataBits) / spi.clockFrequency);
    };
  }
}

// The divider of the datasheet, section 2.3.1.5: truncates, and divides by zero without complaint.
function divide(sio, signed) {
  const dividend = signed ? sio.divDividend | 0 : sio.divDividend >>> 0;
  const divisor = signed ? sio.divDivisor | 0 : sio.divDivisor >>> 0;
  if (divisor === 0) {
    sio.divQuotient = signed && dividend < 0 ? 1 : 0xffffffff;
    sio.divRemainder = dividend >>> 0;
  } else {
    sio.divQuotient = Math.trunc(dividend / divisor) >>> 0;
    sio.divRemainder = (dividend % divisor) >>> 0;
  }
  sio.divCSR = 3;
}
