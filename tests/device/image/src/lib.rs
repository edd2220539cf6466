#![no_std]
use core::hint::black_box;
use wavelift_kernel::{Codec, Effort, Extent, Plan, SampleType, Training, Wavelet};

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! { loop {} }

pub fn lent<T: 'static>(at: usize, len: usize) -> &'static mut [T] {
    unsafe { core::slice::from_raw_parts_mut(black_box(at) as *mut T, black_box(len)) }
}
pub fn codec() -> &'static mut Codec { unsafe { &mut *(black_box(0x2000_0000usize) as *mut Codec) } }
pub fn training() -> &'static mut Training { unsafe { &mut *(black_box(0x2001_0000usize) as *mut Training) } }

pub fn decode() {
    black_box(codec().decode(lent(0x100, 1000), lent(0x2002_0000, 10), lent(0x2003_0000, 10)).is_ok());
}
pub fn encode(wavelet: Wavelet, effort: Effort<'_>) {
    let Ok(plan) = Extent::new(black_box([3, 4, 5])).and_then(|e| Plan::new(wavelet, e, black_box(2))) else { return };
    let t = SampleType::ALL.get(black_box(1)).copied().unwrap_or(SampleType::U8);
    black_box(codec().encode(effort, &plan, t, lent(0x2002_0000, 10), lent(0x2003_0000, 10), lent(0x2004_0000, 10)).is_ok());
}
