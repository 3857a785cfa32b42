//! What the firmware does, on either chip: both cores draw each scene in ever better passes, and then the next scene,
//! and at last flights past the first one.

use cortex_m::singleton;
use firmware_common::{
    flight::{self, Flight, Form},
    mesh,
    stage::{Cornell, NAMES, Pedestal, Stage},
    text,
    tile::{self, Frame},
};
use microlux::scene::Scene;

use crate::{
    board::{self, Board, Console},
    chip,
    fault::{self, Cause},
    hal::{
        fugit::MicrosDurationU32,
        multicore::{Multicore, Stack},
        pac,
    },
    provoke,
    work::{self, Part, Stages, Step},
};

/// The display.
pub const FRAME: Frame = if cfg!(feature = "wide") {
    tile::WIDE
} else {
    tile::SQUARE
};

/// Flights' frames, and memory for them.
#[cfg(not(feature = "full"))]
pub const FORM: Form = flight::SMALL;
#[cfg(not(feature = "full"))]
type Room = flight::SmallRoom;
#[cfg(feature = "full")]
pub const FORM: Form = chip::FULL;
#[cfg(feature = "full")]
type Room = chip::FullRoom;

/// Longest time between two tiles of core 0; what core 1 still does at the end of a pass counts too.
const HANG: MicrosDurationU32 = MicrosDurationU32::millis(8_000);

/// 10 KiB; core 1 takes 8.6 at most, an exception and the guard with it, or the emulator's `size` and `run` fail.
static CORE_1_STACK: Stack<2560> = Stack::new();

pub fn run() -> ! {
    chip::guard_stack();
    let Some(board) = pac::Peripherals::take().and_then(board::start) else {
        fault::stop(Cause::Display)
    };
    let Board {
        screen,
        console,
        timer,
        mut watchdog,
        core_1,
        was_hung,
    } = board;
    if was_hung {
        fault::stop(Cause::Watchdog);
    }
    watchdog.start(HANG);

    work::share(screen);
    let (Some(stages), Some(mut flight)) = (stages(), flight()) else {
        fault::stop(Cause::Scene)
    };
    let (mut power, mut bus, mut fifo) = core_1;
    let mut cores = Multicore::new(&mut power, &mut bus, &mut fifo);
    let (Some(stack), [_, core_1]) = (CORE_1_STACK.take(), cores.cores()) else {
        fault::stop(Cause::Fault)
    };
    if core_1
        .spawn(stack, move || {
            for step in work::steps() {
                match step.part() {
                    Part::Still { scene, pass } => {
                        work::draw(&stages[scene], step, pass, || provoke::on_core(1));
                        work::wait(step);
                    }
                    Part::Frame { .. } => work::help(step),
                }
            }
        })
        .is_err()
    {
        fault::stop(Cause::Fault);
    }
    for step in work::steps() {
        match step.part() {
            Part::Still { scene, pass } => {
                work::draw(&stages[scene], step, pass, || {
                    watchdog.feed();
                    provoke::on_core(0);
                });
                work::finish();
            }
            Part::Frame { flight: way, number } => {
                work::fly(&mut flight, &stages[0], flight::WAYS[way], number);
                watchdog.feed();
            }
        }
        report(&console, step, timer.get_counter().ticks());
        work::advance();
    }
    fault::stop(Cause::Fault)
}

/// The scenes in variables of their own, which both cores read.
fn stages() -> Option<Stages> {
    let cornell = singleton!(: Option<Cornell> = None)?.insert(Cornell::new().ok()?);
    let pedestal = singleton!(: Option<Pedestal> = None)?.insert(Pedestal::new(mesh::baked().ok()?));
    let (box_, camera) = cornell.scene().ok()?;
    let cornell = Stage {
        scene: singleton!(: Option<Scene> = None)?.insert(box_),
        camera,
    };
    let (pedestal, camera) = pedestal.scene().ok()?;
    let mesh = Stage {
        scene: singleton!(: Option<Scene> = None)?.insert(pedestal),
        camera,
    };
    Some([cornell, mesh])
}

/// The flights past the first scene, their memory in a variable of its own.
fn flight() -> Option<Flight<'static, { FORM.scale }>> {
    Flight::new(FORM.size, singleton!(: Room = Room::EMPTY)?).ok()
}

/// Prints what was completed, and when, in microseconds since the start.
fn report(console: &Console, step: Step, microseconds: u64) {
    let us = microseconds as u32;
    match step.part() {
        Part::Still { scene, pass } => line(
            console,
            NAMES[scene],
            &[(" block=", pass.block), (" spp=", pass.spp), (" us=", us)],
        ),
        Part::Frame { flight, number } => line(
            console,
            flight::NAMES[flight],
            &[(" number=", number), (" us=", us)],
        ),
    }
}

fn line(console: &Console, scene: &str, numbers: &[(&str, u32)]) {
    #[cfg(feature = "defmt")]
    defmt::info!("{} {}", scene, numbers);

    for part in [b"frame scene=".as_slice(), scene.as_bytes()] {
        console.write_full_blocking(part);
    }
    for (name, value) in numbers {
        console.write_full_blocking(name.as_bytes());
        let mut digits = [0; 10];
        console.write_full_blocking(text::decimal(*value, &mut digits));
    }
    console.write_full_blocking(b"\n");
}
