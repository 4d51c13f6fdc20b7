//! Files that nobody writes by hand, met at instantiation: refused, and soon.

use std::time::{Duration, Instant};

use biela::fmi::{Category, Instance, Interface, MechanismModel, RESOURCE, Sink, Status, Version};

/// Far more than any of these takes on a busy machine in a build that is not optimised.
const SOON: Duration = Duration::from_secs(20);

struct Silent;

impl Sink for Silent {
    fn write(&self, _: Status, _: Category, _: &str) {}
}

/// Why the text is no mechanism.
fn refusal(text: &str) -> String {
    let folder = tempfile::tempdir().expect("there is room for temporary files");
    std::fs::write(folder.path().join(RESOURCE), text).expect("the folder is ours");
    let start = Instant::now();
    let made = Instance::<MechanismModel>::instantiate(
        Version::Fmi2,
        "guid",
        folder.path(),
        Interface::CoSimulation,
        Box::new(Silent),
        false,
    );
    assert!(start.elapsed() < SOON, "{:?}", start.elapsed());
    made.expect_err("it is no mechanism").to_string()
}

const HEAD: &str = "format = 1\nname = \"hostile\"\n";

#[test]
fn nesting_of_any_kind_and_depth_is_refused() {
    let deep = |open: &str, close: &str| {
        let depth = 100_000;
        format!("{HEAD}x = {}1{}\n", open.repeat(depth), close.repeat(depth))
    };
    let expression = |inside: &str| format!("{HEAD}[parameters]\nx = \"{inside}\"\n");
    for text in [
        deep("[", "]"),
        deep("{ a = ", "}"),
        deep("[", ""),
        format!("{HEAD}{}b = 1\n", "a.".repeat(100_000)),
        format!("{HEAD}[{}b]\n", "a.".repeat(100_000)),
        expression(&format!("{}1{}", "(".repeat(100_000), ")".repeat(100_000))),
        expression(&format!("{}1", "-".repeat(100_000))),
        expression(&format!("{}1", "2^".repeat(100_000))),
        expression(&format!(
            "{}1{}",
            "sin(".repeat(100_000),
            ")".repeat(100_000)
        )),
    ] {
        assert!(!refusal(&text).is_empty());
    }
}

#[test]
fn numbers_beyond_all_bounds_are_refused() {
    for number in ["1e999999999", &"9".repeat(1_000_000), "inf", "nan"] {
        let text = format!("{HEAD}[parameters]\nx = {number}\n");
        let reason = refusal(&text);
        assert!(reason.contains("not finite"), "{reason}");
    }
}

/// The triangle, far larger than numbers square.
#[test]
fn lengths_that_overflow_are_refused() {
    let text = include_str!("../../mechanisms/tlv.toml");
    let text = text.replace("value = 0", "value = 1e300, unit = \"m\" } # 0");
    let reason = refusal(&text);
    assert!(reason.contains("no finite value"), "{reason}");
}

#[test]
fn thousands_of_repeated_keys_are_refused() {
    let text = format!("{HEAD}[bodies.a]\n{}", "mass = 1\n".repeat(30_000));
    let reason = refusal(&text);
    assert!(reason.contains("`mass` is given twice"), "{reason:.200}");
}

fn bodies(count: usize) -> String {
    let bodies = (0..count).map(|k| format!("b{k} = {{ markers = {{ O = [0, 0] }} }}\n"));
    format!("{HEAD}[bodies]\n{}", bodies.collect::<String>())
}

#[test]
fn thousands_of_bodies_that_nothing_drives_are_refused() {
    let reason = refusal(&bodies(10_000));
    assert!(reason.contains("30000 degrees of freedom"), "{reason:.200}");
    assert!(reason.contains("and 9992 others"), "{reason}");
}

#[test]
fn a_million_bodies_are_not_even_read() {
    let reason = refusal(&bodies(1_000_000));
    assert!(
        reason.contains("it has more than 16777216 bytes"),
        "{reason:.200}"
    );
}
