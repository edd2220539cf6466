#![no_std]
#![no_main]
#[unsafe(no_mangle)]
pub extern "C" fn _start() {
image::decode(); let w = wavelift_kernel::Wavelet::ALL.get(core::hint::black_box(3)).copied().unwrap_or(wavelift_kernel::Wavelet::Haar); image::encode(w, wavelift_kernel::Effort::Default(image::training()));
}
