//! Counts what a QEMU machine executes: instructions, Cortex-M0+ cycles, marked regions, and each address.
//!
//! `-plugin libqemu_count.so,report=FILE[,histogram=FILE][,stages=FILE][,core=CORE][,begin=ADDRESS:BYTES,end=ADDRESS:BYTES,regions=ADDRESS:BYTES]`
//!
//! `begin` and `end` are the two marker functions of the firmware, `regions` the array that they store to: the place
//! of the stored byte is the number of the region. The report has a line `total INSTRUCTIONS CYCLES` and for each
//! region `region NUMBER ENTRIES INSTRUCTIONS CYCLES`, which includes the markers' own cost, the same at every entry.
//! The histogram is a CSV, a line for each address executed. Two runs of one program give the same files.
//!
//! With `stages` ([`stages`]) the report also says what each stage of a region took, and how often each block was begun.
//!
//! The cycles are those of `core` ([`cycles`]: `m0plus`, `m4` or `hazard3`), a Cortex-M0+ if it is not said; on another they
//! mean nothing. One virtual CPU is assumed.

mod api;
mod cycles;
mod stages;

use std::{
    collections::BTreeMap,
    ffi::{CStr, c_char, c_int, c_uint, c_void},
    fmt::Write as _,
    fs,
    ops::Range,
    ptr,
    sync::{
        Mutex, OnceLock,
        atomic::{AtomicU64, Ordering::Relaxed},
    },
};

use api::{Block, Id, Info};
use cycles::Core;

#[unsafe(no_mangle)]
#[allow(non_upper_case_globals, reason = "QEMU looks for this name")]
pub static qemu_plugin_version: c_int = 1;

/// As many as the firmware has bytes to mark them with.
const MOST_REGIONS: usize = 256;

/// Instructions and cycles, either since the start or of a region.
struct Count {
    instructions: AtomicU64,
    cycles: AtomicU64,
}

impl Count {
    const fn new() -> Self {
        Self {
            instructions: AtomicU64::new(0),
            cycles: AtomicU64::new(0),
        }
    }

    fn add(&self, instructions: u64, cycles: u64) {
        self.instructions.fetch_add(instructions, Relaxed);
        self.cycles.fetch_add(cycles, Relaxed);
    }

    fn get(&self) -> (u64, u64) {
        (self.instructions.load(Relaxed), self.cycles.load(Relaxed))
    }
}

struct Region {
    entries: AtomicU64,
    spent: Count,
    /// The totals when it was opened.
    opened: Mutex<Option<(u64, u64)>>,
}

/// A translated block: a straight run of instructions, executed as a whole.
struct Run {
    start: u64,
    end: u64,
    ends_in_conditional_branch: bool,
    instructions: u64,
    cycles: u64,
    /// What of it belongs to which stage, if there are stages.
    stages: stages::Block,
}

/// An executed address.
struct Line {
    bytes: u64,
    opcode: u32,
    cycles: u64,
    count: AtomicU64,
}

struct Settings {
    is_arm: bool,
    report: String,
    histogram: Option<String>,
    stages: Option<stages::Table>,
    core: Core,
    begin: Range<u64>,
    end: Range<u64>,
    regions: Range<u64>,
}

static SETTINGS: OnceLock<Settings> = OnceLock::new();
static TOTAL: Count = Count::new();
/// Where the last block would have gone on had its conditional branch not been taken; 0 if it had none.
static FALL_THROUGH: AtomicU64 = AtomicU64::new(0);
static LINES: Mutex<BTreeMap<u64, &'static Line>> = Mutex::new(BTreeMap::new());
static REGIONS: [Region; MOST_REGIONS] = [const {
    Region {
        entries: AtomicU64::new(0),
        spent: Count::new(),
        opened: Mutex::new(None),
    }
}; MOST_REGIONS];

extern "C" fn on_block(_cpu: c_uint, data: *mut c_void) {
    // SAFETY: `data` is the `Run` that `on_translation` leaked for this block.
    let run = unsafe { &*data.cast::<Run>() };
    let expected = FALL_THROUGH.swap(
        if run.ends_in_conditional_branch {
            run.end
        } else {
            0
        },
        Relaxed,
    );
    let settings = SETTINGS.get().expect("set before the first translation");
    let taken = if expected != 0 && expected != run.start {
        settings.core.taken()
    } else {
        0
    };
    TOTAL.add(run.instructions, run.cycles + taken);
    if settings.stages.is_some() {
        stages::on_block(run.start, run.end, &run.stages, taken);
    }
}

/// The region whose byte lies at `address`, if that is one.
fn region_at(address: u64) -> Option<&'static Region> {
    let regions = &SETTINGS.get()?.regions;
    if !regions.contains(&address) {
        return None;
    }
    REGIONS.get((address - regions.start) as usize)
}

extern "C" fn on_begin(_cpu: c_uint, _access: u32, address: u64, _data: *mut c_void) {
    if let Some(region) = region_at(address) {
        region.entries.fetch_add(1, Relaxed);
        *region.opened.lock().unwrap() = Some(TOTAL.get());
        let regions = SETTINGS.get().map_or(0, |settings| settings.regions.start);
        stages::open((address - regions) as usize);
    }
}

extern "C" fn on_end(_cpu: c_uint, _access: u32, address: u64, _data: *mut c_void) {
    let Some(region) = region_at(address) else {
        return;
    };
    stages::close();
    let (instructions, cycles) = TOTAL.get();
    if let Some(opened) = region.opened.lock().unwrap().take() {
        region.spent.add(instructions - opened.0, cycles - opened.1);
    }
}

extern "C" fn on_translation(_id: Id, block: *mut Block) {
    let settings = SETTINGS.get().expect("set before the first translation");
    let mut lines = LINES.lock().unwrap();
    let mut before = None;
    let mut run = Run {
        start: 0,
        end: 0,
        ends_in_conditional_branch: false,
        instructions: 0,
        cycles: 0,
        stages: stages::Block::default(),
    };
    // SAFETY: QEMU lends the block for this call, and every index is below the number it gives.
    for index in 0..unsafe { api::qemu_plugin_tb_n_insns(block) } {
        let instruction = unsafe { api::qemu_plugin_tb_get_insn(block, index) };
        let address = unsafe { api::qemu_plugin_insn_vaddr(instruction) };
        // SAFETY: the instruction is valid as above; see `decode` for its bytes.
        let (opcode, bytes) = unsafe { decode(instruction, settings.is_arm) };
        let waits = before.map_or(0, |before| settings.core.waits(before, opcode, bytes));
        let cycles = settings.core.cycles(opcode, bytes) + waits;
        before = Some((opcode, bytes));
        if index == 0 {
            run.start = address;
        }
        run.end = address + bytes;
        run.ends_in_conditional_branch = settings.core.is_conditional_branch(opcode, bytes);
        run.instructions += 1;
        run.cycles += cycles;
        if let Some(table) = &settings.stages {
            run.stages.push(table.stage(address), cycles);
            run.stages.is_call = stages::is_call(opcode, bytes, settings.is_arm);
        }

        for (marker, callback) in [
            (&settings.begin, on_begin as api::OnMemory),
            (&settings.end, on_end),
        ] {
            if marker.contains(&address) {
                // SAFETY: QEMU copies what it needs; no data is passed.
                unsafe {
                    api::qemu_plugin_register_vcpu_mem_cb(
                        instruction,
                        callback,
                        api::NO_REGISTERS,
                        api::WRITES,
                        ptr::null_mut(),
                    );
                }
            }
        }
        if settings.histogram.is_some() {
            let line = *lines.entry(address).or_insert_with(|| {
                Box::leak(Box::new(Line {
                    bytes,
                    opcode,
                    cycles,
                    count: AtomicU64::new(0),
                }))
            });
            // SAFETY: the counter is leaked, so it outlives the translated code that adds to it.
            unsafe {
                api::qemu_plugin_register_vcpu_insn_exec_inline(
                    instruction,
                    api::ADD_U64,
                    line.count.as_ptr().cast(),
                    1,
                );
            }
        }
    }
    let run = ptr::from_ref::<Run>(Box::leak(Box::new(run)));
    // SAFETY: `run` is leaked and never written again.
    unsafe {
        api::qemu_plugin_register_vcpu_tb_exec_cb(block, on_block, api::NO_REGISTERS, run.cast_mut().cast())
    };
}

/// Opcode and length in bytes. QEMU 7.2 gives 4 bytes for a 2-byte Thumb instruction in front of a 1 KiB border, so
/// that the opcode decides there.
///
/// # Safety
/// `instruction` is one that QEMU lends at present.
unsafe fn decode(instruction: *const api::Instruction, is_arm: bool) -> (u32, u64) {
    // SAFETY: the caller's; the data holds at least the 2 bytes of the shortest instruction, and all 4 if it is long.
    let halfword = |at| unsafe {
        let data = api::qemu_plugin_insn_data(instruction).add(at);
        u32::from(u16::from_le_bytes([*data, *data.add(1)]))
    };
    // SAFETY: the caller's.
    let size = unsafe { api::qemu_plugin_insn_size(instruction) };
    let is_long = if is_arm {
        halfword(0) >> 11 >= 0b11101
    } else {
        size == 4
    };
    if is_long {
        (halfword(0) << 16 | halfword(2), 4)
    } else {
        (halfword(0), 2)
    }
}

extern "C" fn on_exit(_id: Id, _data: *mut c_void) {
    let settings = SETTINGS.get().expect("set at the start");
    let (instructions, cycles) = TOTAL.get();
    let mut report = format!("total {instructions} {cycles}\n");
    for (number, region) in REGIONS.iter().enumerate() {
        let entries = region.entries.load(Relaxed);
        if entries > 0 {
            let (instructions, cycles) = region.spent.get();
            let _ = writeln!(report, "region {number} {entries} {instructions} {cycles}");
        }
    }
    stages::report(&mut report);
    write(&settings.report, &report);

    if let Some(file) = &settings.histogram {
        let mut table = String::from("address,bytes,opcode,count,cycles_each\n");
        for (address, line) in LINES.lock().unwrap().iter() {
            let Line {
                bytes,
                opcode,
                cycles,
                count,
            } = line;
            let _ = writeln!(
                table,
                "{address:#x},{bytes},{opcode:#x},{},{cycles}",
                count.load(Relaxed)
            );
        }
        write(file, &table);
    }
}

fn write(file: &str, text: &str) {
    if let Err(error) = fs::write(file, text) {
        eprintln!("qemu-count: {file}: {error}");
    }
}

/// `0x1000:24` as a range of addresses.
fn range(text: &str) -> Option<Range<u64>> {
    let (start, length) = text.split_once(':')?;
    let start = u64::from_str_radix(start.strip_prefix("0x")?, 16).ok()?;
    Some(start..start + length.parse::<u64>().ok()?)
}

fn settings(target: &[u8], arguments: &[String]) -> Option<Settings> {
    let mut settings = Settings {
        is_arm: target == b"arm",
        report: String::new(),
        histogram: None,
        stages: None,
        core: Core::M0Plus,
        begin: 0..0,
        end: 0..0,
        regions: 0..0,
    };
    for argument in arguments {
        match argument.split_once('=')? {
            ("report", file) => settings.report = file.to_owned(),
            ("histogram", file) => settings.histogram = Some(file.to_owned()),
            ("stages", file) => settings.stages = Some(stages::Table::read(file)?),
            ("core", name) => settings.core = Core::named(name)?,
            ("begin", marker) => settings.begin = range(marker)?,
            ("end", marker) => settings.end = range(marker)?,
            ("regions", array) => settings.regions = range(array)?,
            _ => return None,
        }
    }
    (!settings.report.is_empty()).then_some(settings)
}

/// QEMU's entry: 0 accepts the arguments.
///
/// # Safety
/// As QEMU calls it: `info` and `argc` strings at `argv` are valid for the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qemu_plugin_install(
    id: Id,
    info: *const Info,
    argc: c_int,
    argv: *const *const c_char,
) -> c_int {
    // SAFETY: the caller's.
    let text = |string| unsafe { CStr::from_ptr(string) };
    let arguments: Vec<_> = (0..argc as usize)
        // SAFETY: `argv` has `argc` entries.
        .map(|index| text(unsafe { *argv.add(index) }).to_string_lossy().into_owned())
        .collect();
    // SAFETY: `info` is valid, and its first field is the target's name in every version of the interface.
    let target = text(unsafe { (*info).target_name });
    let Some(settings) = settings(target.to_bytes(), &arguments) else {
        eprintln!("qemu-count: wrong arguments: {arguments:?}");
        return 1;
    };
    if SETTINGS.set(settings).is_err() {
        eprintln!("qemu-count: loaded twice");
        return 1;
    }
    // SAFETY: both callbacks live as long as the plugin does.
    unsafe {
        api::qemu_plugin_register_vcpu_tb_trans_cb(id, on_translation);
        api::qemu_plugin_register_atexit_cb(id, on_exit, ptr::null_mut());
    }
    0
}
