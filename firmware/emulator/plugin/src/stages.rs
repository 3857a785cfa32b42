//! Which stage of the work each instruction of a region belongs to.
//!
//! A table gives addresses a stage: lines `START END STAGE`, in hexadecimal but for the stage, rising. Code without one (0)
//! serves whoever called it, and counts for the stage of the call: calls are followed until they return.

use std::{collections::BTreeMap, fmt::Write as _, fs, sync::Mutex};

/// Stages by address.
pub struct Table(Vec<(u64, u64, u8)>);

impl Table {
    pub fn read(file: &str) -> Option<Table> {
        let text = fs::read_to_string(file).ok()?;
        let line = |line: &str| {
            let mut words = line.split(' ');
            let mut address = || u64::from_str_radix(words.next()?, 16).ok();
            Some((address()?, address()?, words.next()?.parse().ok()?))
        };
        text.lines().map(line).collect::<Option<_>>().map(Table)
    }

    /// 0 where there is none.
    pub fn stage(&self, address: u64) -> u8 {
        let after = self.0.partition_point(|&(start, ..)| start <= address);
        let range = after.checked_sub(1).map(|index| self.0[index]);
        range.map_or(0, |(_, end, stage)| if address < end { stage } else { 0 })
    }
}

/// What a block takes of each stage, in order.
#[derive(Default)]
pub struct Block {
    parts: Vec<Part>,
    /// Whether it ends with a call.
    pub is_call: bool,
}

struct Part {
    stage: u8,
    instructions: u64,
    cycles: u64,
}

impl Block {
    pub fn push(&mut self, stage: u8, cycles: u64) {
        match self.parts.last_mut() {
            Some(part) if part.stage == stage => {
                part.instructions += 1;
                part.cycles += cycles;
            }
            _ => self.parts.push(Part {
                stage,
                instructions: 1,
                cycles,
            }),
        }
    }
}

#[derive(Default)]
struct State {
    /// The region that is open.
    region: Option<usize>,
    /// Where each call returns to, and the stage that it was made for.
    calls: Vec<(u64, u8)>,
    last: u8,
    /// By region and stage: instructions and cycles.
    spent: BTreeMap<(usize, u8), (u64, u64)>,
    /// By region and address: how often a block began there.
    blocks: BTreeMap<(usize, u64), u64>,
}

static STATE: Mutex<Option<State>> = Mutex::new(None);

fn with(change: impl FnOnce(&mut State)) {
    if let Ok(mut state) = STATE.lock() {
        change(state.get_or_insert_default());
    }
}

pub fn open(region: usize) {
    with(|state| {
        state.region = Some(region);
        state.calls.clear();
    });
}

pub fn close() {
    with(|state| state.region = None);
}

/// A block was executed; `taken` cycles if the branch before it was taken, which are that one's.
pub fn on_block(start: u64, end: u64, block: &Block, taken: u64) {
    with(|state| {
        let Some(region) = state.region else { return };
        while state.calls.last().is_some_and(|call| call.0 == start) {
            state.calls.pop();
        }
        *state.blocks.entry((region, start)).or_default() += 1;
        if taken > 0 {
            state.spent.entry((region, state.last)).or_default().1 += taken;
        }
        for part in &block.parts {
            let callers = || state.calls.last().map_or(0, |call| call.1);
            let stage = if part.stage == 0 { callers() } else { part.stage };
            let spent = state.spent.entry((region, stage)).or_default();
            spent.0 += part.instructions;
            spent.1 += part.cycles;
            state.last = stage;
        }
        if block.is_call {
            state.calls.push((end, state.last));
        }
    });
}

/// Lines `stage REGION STAGE INSTRUCTIONS CYCLES`, then `block REGION ADDRESS COUNT`.
pub fn report(text: &mut String) {
    with(|state| {
        for (&(region, stage), &(instructions, cycles)) in &state.spent {
            let _ = writeln!(text, "stage {region} {stage} {instructions} {cycles}");
        }
        for (&(region, address), &count) in &state.blocks {
            let _ = writeln!(text, "block {region} {address} {count}");
        }
    });
}

/// Whether an instruction keeps the address after it to return to. The first halfword of a long one is on top.
pub const fn is_call(opcode: u32, bytes: u64, is_arm: bool) -> bool {
    match (is_arm, bytes) {
        (true, 4) => opcode >> 27 == 0b11110 && opcode & 0xd000 == 0xd000, // BL
        (true, _) => opcode & 0xff87 == 0x4780,                            // BLX
        (false, 4) => matches!((opcode >> 16) & 0xfff, 0x0ef | 0x0e7),     // JAL, JALR with ra
        (false, _) => opcode & 0xe003 == 0x2001 || (opcode & 0xf07f == 0x9002 && opcode & 0xf80 != 0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knows_calls() {
        for (opcode, bytes, is_arm, text) in [
            (0xf000_f801, 4, true, "bl"),
            (0x4788, 2, true, "blx r1"),
            (0x00ef_0040, 4, false, "jal ra"),
            (0x80e7_0000, 4, false, "jalr ra"),
            (0x2011, 2, false, "c.jal"),
            (0x9582, 2, false, "c.jalr a1"),
        ] {
            assert!(is_call(opcode, bytes, is_arm), "{text}");
        }
        for (opcode, bytes, is_arm, text) in [
            (0xf000_8001, 4, true, "a wide branch"),
            (0x4770, 2, true, "bx lr"),
            (0x006f_0040, 4, false, "j"),
            (0x9002, 2, false, "c.ebreak"),
            (0xa001, 2, false, "c.j"),
        ] {
            assert!(!is_call(opcode, bytes, is_arm), "{text}");
        }
    }

    /// Code without a stage counts for who called it, and its caller goes on after it.
    #[test]
    fn calls_are_followed() {
        let mut caller = Block::default();
        caller.push(3, 2);
        caller.push(3, 3);
        caller.is_call = true;
        let mut helper = Block::default();
        helper.push(0, 1);
        let mut after = Block::default();
        after.push(0, 1);
        after.push(4, 1);
        open(7);
        on_block(100, 106, &caller, 0);
        on_block(500, 502, &helper, 0);
        on_block(106, 110, &after, 1);
        close();
        on_block(500, 502, &helper, 0);
        let mut text = String::new();
        report(&mut text);
        assert_eq!(
            text,
            "stage 7 0 1 1\nstage 7 3 3 7\nstage 7 4 1 1\nblock 7 100 1\nblock 7 106 1\nblock 7 500 1\n"
        );
    }
}
