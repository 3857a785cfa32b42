//! What lies below core 0's stack: 256 bytes that nothing may touch.
//!
//! Core 1's stack has the guard that `rp2040-hal` sets up. An overflow of either is a fault at once ([`crate::fault`]).

use cortex_m::peripheral::MPU;

/// Bytes of the guard, a size and an alignment that the protection unit knows.
const BYTES: u32 = 256;

unsafe extern "C" {
    /// Lower end of core 0's stack, from `memory.x`.
    static _stack_end: u32;
}

/// Sets the guard up on the core that calls, which is core 0.
pub fn install(mpu: &MPU) {
    const VALID_REGION_0: u32 = 1 << 4;
    const ENABLE: u32 = 1;
    const SIZE: u32 = (BYTES.ilog2() - 1) << 1;
    const NO_EXECUTION: u32 = 1 << 28;
    const DEFAULT_MAP_ELSEWHERE: u32 = 1 << 2;
    let bottom = &raw const _stack_end as u32;
    // SAFETY: the region takes away access to the lowest bytes of this core's stack, which no value occupies as long
    // as the stack is large enough; everything else keeps the access it has by default.
    unsafe {
        mpu.rbar.write(bottom | VALID_REGION_0);
        mpu.rasr.write(NO_EXECUTION | SIZE | ENABLE);
        mpu.ctrl.write(DEFAULT_MAP_ELSEWHERE | ENABLE);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}
