//! Times of all cases.

use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use yardstick::comparisons::timed_cases;

/// Times each case; one iteration is its whole span.
fn times(criterion: &mut Criterion) {
    for case in timed_cases() {
        let span = case.span().expect("a sweep has steps");
        let mut group = criterion.benchmark_group(&case.name);
        group.throughput(Throughput::Elements(span));
        let mut run = None;
        group.bench_function(case.size.to_string(), |bencher| {
            let run = run.get_or_insert_with(|| case.run().expect("the case exists"));
            bencher.iter_custom(|iterations| run(iterations * span));
        });
        group.finish();
    }
}

fn short() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1200))
        .sample_size(40)
}

criterion_group! {
    name = benches;
    config = short();
    targets = times
}
criterion_main!(benches);
