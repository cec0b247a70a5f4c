//! Memory asked for before it is needed.

// The instruction has no safe form for all processors; it reads nothing.
#![allow(unsafe_code)]

/// Asks for the cache line of `values[i]`, if there is one.
#[inline(always)]
pub(crate) fn prefetch<T>(values: &[T], i: usize) {
    if let Some(value) = values.get(i) {
        line(value);
    }
}

/// Asks for the cache line in which `value` starts.
#[inline(always)]
#[cfg(target_arch = "x86_64")]
pub(crate) fn line<T>(value: &T) {
    use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    // SAFETY: the address is that of a value, and asking for a line has no effect but on time.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(value).cast()) }
}

/// Does nothing on this processor.
#[inline(always)]
#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn line<T>(_: &T) {}
