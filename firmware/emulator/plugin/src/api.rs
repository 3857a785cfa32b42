//! The part of QEMU's plugin interface, version 1 (QEMU 4.2 to 8.2 and compatible), that counting needs.
//!
//! Declared here because Debian ships the interface without its header; `docs/devel/tcg-plugins.rst` of QEMU's source
//! describes it.

use core::ffi::{c_char, c_int, c_uint, c_void};

/// Names this plugin in every call.
pub type Id = u64;

#[repr(C)]
pub struct Block {
    opaque: [u8; 0],
}

#[repr(C)]
pub struct Instruction {
    opaque: [u8; 0],
}

/// `qemu_info_t`, of which only the first field is read.
#[repr(C)]
pub struct Info {
    pub target_name: *const c_char,
}

pub type OnTranslation = extern "C" fn(Id, *mut Block);
pub type OnExit = extern "C" fn(Id, *mut c_void);
pub type OnExecution = extern "C" fn(c_uint, *mut c_void);
pub type OnMemory = extern "C" fn(c_uint, u32, u64, *mut c_void);

/// `QEMU_PLUGIN_CB_NO_REGS`
pub const NO_REGISTERS: c_int = 0;
/// `QEMU_PLUGIN_MEM_W`
pub const WRITES: c_int = 2;
/// `QEMU_PLUGIN_INLINE_ADD_U64`
pub const ADD_U64: c_int = 0;

unsafe extern "C" {
    pub fn qemu_plugin_register_vcpu_tb_trans_cb(id: Id, callback: OnTranslation);
    pub fn qemu_plugin_register_atexit_cb(id: Id, callback: OnExit, data: *mut c_void);
    pub fn qemu_plugin_tb_n_insns(block: *const Block) -> usize;
    pub fn qemu_plugin_tb_get_insn(block: *const Block, index: usize) -> *mut Instruction;
    pub fn qemu_plugin_insn_data(instruction: *const Instruction) -> *const u8;
    pub fn qemu_plugin_insn_size(instruction: *const Instruction) -> usize;
    pub fn qemu_plugin_insn_vaddr(instruction: *const Instruction) -> u64;
    pub fn qemu_plugin_register_vcpu_tb_exec_cb(
        block: *mut Block,
        callback: OnExecution,
        flags: c_int,
        data: *mut c_void,
    );
    pub fn qemu_plugin_register_vcpu_insn_exec_inline(
        instruction: *mut Instruction,
        operation: c_int,
        counter: *mut c_void,
        operand: u64,
    );
    pub fn qemu_plugin_register_vcpu_mem_cb(
        instruction: *mut Instruction,
        callback: OnMemory,
        flags: c_int,
        accesses: c_int,
        data: *mut c_void,
    );
}
