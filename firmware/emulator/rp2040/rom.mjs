// The part of the boot ROM that firmware calls: memory and bit functions, found through its table.
//
// No ROM image is needed: each function is a BKPT with a number of our own and a return, and its work is done here.
// Its cycles are estimates: about what copying and filling by LDM and STM, or by bytes, costs.

// BKPT numbers of the functions; semihosting is 0xab.
const FIRST = 0xe0;

const TABLE = 0x40;
const CODE = 0x80;
const RETURN = 0x4770;

const bits = {
  count(value) {
    let ones = 0;
    for (let rest = value; rest !== 0; rest &= rest - 1) ones++;
    return ones;
  },
  reverse(value) {
    let result = 0;
    for (let place = 0; place < 32; place++) result = (result << 1) | ((value >>> place) & 1);
    return result >>> 0;
  },
};

const blockCycles = (aligned, bytes) => 20 + (aligned ? bytes * 0.6 : bytes * 7);

function copy(chip, core, aligned) {
  const [to, from, bytes] = core.registers;
  for (let at = 0; at < bytes; at++) chip.writeUint8(to + at, chip.readUint8(from + at));
  return blockCycles(aligned || ((to | from) & 3) === 0, bytes);
}

function fill(chip, core, aligned) {
  const [to, value, bytes] = core.registers;
  for (let at = 0; at < bytes; at++) chip.writeUint8(to + at, value & 255);
  return blockCycles(aligned || (to & 3) === 0, bytes);
}

// Two letters as the ROM's table spells them, and what they do: returns cycles.
const FUNCTIONS = [
  ['MC', (chip, core) => copy(chip, core, false)],
  ['C4', (chip, core) => copy(chip, core, true)],
  ['MS', (chip, core) => fill(chip, core, false)],
  ['S4', (chip, core) => fill(chip, core, true)],
  ['P3', (chip, core) => { core.registers[0] = bits.count(core.registers[0]); return 18; }],
  ['R3', (chip, core) => { core.registers[0] = bits.reverse(core.registers[0]); return 23; }],
  ['L3', (chip, core) => { core.registers[0] = Math.clz32(core.registers[0]); return 13; }],
  ['T3', (chip, core) => {
    const value = core.registers[0] | 0;
    core.registers[0] = value === 0 ? 32 : 31 - Math.clz32(value & -value);
    return 12;
  }],
];

const tag = (letters) => letters.charCodeAt(0) | (letters.charCodeAt(1) << 8);
const LOOKUP = FIRST + FUNCTIONS.length;

// Lays the ROM out: signature, pointers, table, functions.
export function install(chip) {
  const view = new DataView(chip.bootrom.buffer);
  const place = (number) => CODE + 4 * (number - FIRST);
  view.setUint32(0x10, 0x02014d75, true); // "uM", 1, version 2
  view.setUint16(0x14, TABLE, true);
  view.setUint16(0x16, TABLE, true);
  view.setUint16(0x18, place(LOOKUP) | 1, true);
  FUNCTIONS.forEach(([letters], index) => {
    view.setUint16(TABLE + 4 * index, tag(letters), true);
    view.setUint16(TABLE + 4 * index + 2, place(FIRST + index) | 1, true);
  });
  view.setUint32(TABLE + 4 * FUNCTIONS.length, 0, true);
  for (let number = FIRST; number <= LOOKUP; number++) {
    view.setUint16(place(number), 0xbe00 | number, true);
    view.setUint16(place(number) + 2, RETURN, true);
  }
}

// Serves a BKPT inside the ROM; false if `number` is none of its functions.
export function serve(chip, core, number) {
  if (number < FIRST || number > LOOKUP) return false;
  if (number === LOOKUP) {
    const wanted = core.registers[1] & 0xffff;
    const index = FUNCTIONS.findIndex(([letters]) => tag(letters) === wanted);
    core.registers[0] = index < 0 ? 0 : (CODE + 4 * index) | 1;
    core.cycles += 10 + 6 * (index < 0 ? FUNCTIONS.length : index);
  } else {
    core.cycles += Math.round(FUNCTIONS[number - FIRST][1](chip, core));
  }
  return true;
}
