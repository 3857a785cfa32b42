//! The display's SPI bus: commands wait, pixels go out by DMA while the processor is elsewhere.

use core::convert::Infallible;

use crate::hal::{
    dma::{CH0, Channel, single_buffer},
    gpio::{
        FunctionSioOutput, FunctionSpi, Pin, PullDown,
        bank0::{Gpio18, Gpio19, Gpio20},
    },
    pac::SPI0,
    spi::{Enabled, Spi},
};
use cortex_m::singleton;
use embedded_dma::ReadBuffer;
use embedded_hal::{digital::OutputPin, spi::SpiBus};
use firmware_common::tile;
use mipidsi::interface::{Interface, InterfaceKind};

/// Bytes of one DMA transfer: a tile.
const CAPACITY: usize = 2 * tile::PIXELS;

pub type Port = Spi<
    Enabled,
    SPI0,
    (
        Pin<Gpio19, FunctionSpi, PullDown>,
        Pin<Gpio18, FunctionSpi, PullDown>,
    ),
    8,
>;
pub type DataPin = Pin<Gpio20, FunctionSioOutput, PullDown>;

/// The filled start of a buffer.
struct Bytes {
    buffer: &'static mut [u8; CAPACITY],
    filled: usize,
}

// SAFETY: the buffer is static, and exclusive to this value, which the transfer owns until it is over.
unsafe impl ReadBuffer for Bytes {
    type Word = u8;

    unsafe fn read_buffer(&self) -> (*const u8, usize) {
        (self.buffer.as_ptr(), self.filled)
    }
}

enum Line {
    Idle {
        channel: Channel<CH0>,
        port: Port,
        buffer: &'static mut [u8; CAPACITY],
    },
    Sending(single_buffer::Transfer<Channel<CH0>, Bytes, Port>),
}

/// What `mipidsi` talks to. Its chip select stays low: the display is alone on the bus.
pub struct Bus {
    /// `None` only inside a method.
    line: Option<Line>,
    /// The buffer that is not on its way.
    spare: Option<&'static mut [u8; CAPACITY]>,
    data: DataPin,
}

impl Bus {
    /// The one bus; `None` when called again.
    pub fn new(channel: Channel<CH0>, port: Port, data: DataPin) -> Option<Self> {
        let buffer = singleton!(: [u8; CAPACITY] = [0; CAPACITY])?;
        let spare = singleton!(: [u8; CAPACITY] = [0; CAPACITY])?;
        Some(Self {
            line: Some(Line::Idle {
                channel,
                port,
                buffer,
            }),
            spare: Some(spare),
            data,
        })
    }

    /// Whether every byte has left.
    pub fn is_idle(&mut self) -> bool {
        if matches!(&self.line, Some(Line::Sending(transfer)) if !transfer.is_done()) {
            return false;
        }
        self.finish();
        true
    }

    /// Waits until the last byte has left.
    fn finish(&mut self) {
        self.line = self.line.take().map(|line| match line {
            Line::Sending(transfer) => {
                let (channel, bytes, port) = transfer.wait();
                Line::Idle {
                    channel,
                    port,
                    buffer: bytes.buffer,
                }
            }
            idle => idle,
        });
        if let Some(Line::Idle { port, .. }) = &mut self.line {
            let Ok(()) = port.flush();
        }
    }

    /// Sends `filled` bytes of `buffer`, once what is under way has left, and returns without waiting for them.
    fn start(&mut self, buffer: &'static mut [u8; CAPACITY], filled: usize) {
        self.finish();
        if let Some(Line::Idle {
            channel,
            port,
            buffer: free,
        }) = self.line.take()
        {
            let transfer = single_buffer::Config::new(channel, Bytes { buffer, filled }, port).start();
            self.line = Some(Line::Sending(transfer));
            self.spare = Some(free);
        }
    }

    fn write(&mut self, bytes: &[u8]) {
        if let Some(Line::Idle { port, .. }) = &mut self.line {
            let Ok(()) = port.write(bytes);
            let Ok(()) = port.flush();
        }
    }
}

impl Interface for Bus {
    type Word = u8;
    type Error = Infallible;

    const KIND: InterfaceKind = InterfaceKind::Serial4Line;

    fn send_command(&mut self, command: u8, args: &[u8]) -> Result<(), Infallible> {
        self.finish();
        self.data.set_low()?;
        self.write(&[command]);
        self.data.set_high()?;
        self.write(args);
        Ok(())
    }

    fn send_pixels<const N: usize>(
        &mut self,
        pixels: impl IntoIterator<Item = [u8; N]>,
    ) -> Result<(), Infallible> {
        let mut pixels = pixels.into_iter().peekable();
        while pixels.peek().is_some() {
            let Some(buffer) = self.spare.take() else {
                break;
            };
            let mut filled = 0;
            for (place, pixel) in buffer.chunks_exact_mut(N).zip(pixels.by_ref()) {
                place.copy_from_slice(&pixel);
                filled += N;
            }
            self.start(buffer, filled);
        }
        Ok(())
    }

    fn send_repeated_pixel<const N: usize>(&mut self, pixel: [u8; N], count: u32) -> Result<(), Infallible> {
        self.send_pixels((0..count).map(|_| pixel))
    }
}
