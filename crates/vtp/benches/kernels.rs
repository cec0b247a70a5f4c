//! The kernels of `vtp-fast` on lists of several lengths, in windows per second, with every set of
//! instructions that the processor has.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use geobench_vtp::bench_support::{Kernel, KernelBench};
use geobench_window::simd::Instructions;

fn kernels(criterion: &mut Criterion) {
    for (name, kernel) in [
        ("compare", Kernel::Compare),
        ("measure", Kernel::Measure),
        ("carry", Kernel::Carry),
    ] {
        let mut group = criterion.benchmark_group(name);
        for len in [4, 16, 64] {
            group.throughput(Throughput::Elements(len as u64));
            for instructions in Instructions::ALL {
                if instructions.is_available() {
                    let mut bench = KernelBench::new(len, instructions);
                    let id = BenchmarkId::new(instructions.to_string(), len);
                    group.bench_function(id, |b| b.iter(|| black_box(bench.run(kernel))));
                }
            }
        }
        group.finish();
    }
}

criterion_group!(benches, kernels);
criterion_main!(benches);
