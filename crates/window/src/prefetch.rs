//! Requests for cache lines before they are needed.

// The instruction has no safe form on all processors. It reads nothing.
#![allow(unsafe_code)]

/// Bytes of a cache line.
const LINE: usize = 64;

/// Prefetches all cache lines of `values[i]`. Has no effect if there is no such value.
#[inline]
pub fn prefetch<T>(values: &[T], i: usize) {
    let value = values.as_ptr().wrapping_add(i).cast::<u8>();
    let size = size_of::<T>();
    for line in 0..size.div_ceil(LINE) {
        ask(value.wrapping_add(LINE * line));
    }
    if align_of::<T>() < LINE && !LINE.is_multiple_of(size) {
        // An unaligned value may end in one more line.
        ask(value.wrapping_add(size - 1));
    }
}

/// Prefetches the cache line in which `value` starts.
#[inline(always)]
#[allow(clippy::inline_always)] // One instruction.
pub fn prefetch_line<T>(value: &T) {
    ask(std::ptr::from_ref(value).cast());
}

/// Prefetches the cache line of an address.
#[inline]
#[cfg(target_arch = "x86_64")]
fn ask(address: *const u8) {
    use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    // SAFETY: prefetching accepts any address and has no effect but on time.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(address.cast()) }
}

/// Does nothing on this processor.
#[inline]
#[cfg(not(target_arch = "x86_64"))]
fn ask(_: *const u8) {}
