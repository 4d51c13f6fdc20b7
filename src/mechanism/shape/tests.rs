//! Sections, masses and faults of shapes against closed forms and fine outlines.

use crate::mechanism::{BodyId, Dual, Mechanism, ParameterId, Section, Source};

/// Reads a mechanism whose body has these markers and shapes.
fn read(markers: &str, rest: &str) -> Result<Mechanism, String> {
    let text = format!(
        "format = 1\nname = \"plate\"\n[ground.markers]\nO = [0, 0]\n[bodies.a]\nmarkers = {{ {markers} }}\n\
         {rest}\n[freedoms]\nturn = {{ coordinate = \"angle\", markers = [\"ground.O\", \"a.O\"] }}\n\
         [joints]\npin = {{ type = \"revolute\", markers = [\"ground.O\", \"a.O\"] }}\n"
    );
    let source = Source::new("plate.toml", &*text);
    Mechanism::parse(&source)
        .map(|(mechanism, _)| mechanism)
        .map_err(|problems| problems[0].one_line(&source))
}

fn section(markers: &str, shapes: &str) -> Section<f64> {
    let shapes = format!("mass = 1\ninertia = 1\n[bodies.a.shapes]\n{shapes}");
    let mechanism = read(&format!("O = [0, 0], {markers}"), &shapes).expect("it is right");
    let section = mechanism.section_of(BodyId(0), &[]);
    section.expect("it has an area")
}

/// Largest difference of a section from what it should be, relative to each size.
fn difference(found: &Section<f64>, [area, x, y, second]: [f64; 4]) -> f64 {
    let length = area.sqrt();
    let parts = [
        (found.area - area) / area,
        (found.first[0] - x) / (area * length),
        (found.first[1] - y) / (area * length),
        (found.second - second) / (area * area),
    ];
    parts
        .into_iter()
        .fold(0.0, |most, part| part.abs().max(most))
}

/// Some roundings of sums of ten pieces.
const ROUNDING: f64 = 1e-14;

#[test]
fn a_rounded_polygon_has_its_section() {
    let markers = "A = [0, 0], B = [0.1, 0], C = [0.12, 0.05], D = [0.03, 0.08]";
    // The polygon's own integrals with an edge strip of width r and sectors at the corners, as summed
    // over a fine outline with extrapolation, to the digits given.
    let right = [0.0102057594187, 5.970667e-4, 3.366790e-4, 6.43163270741e-5];
    for order in ["\"A\", \"B\", \"C\", \"D\"", "\"C\", \"B\", \"A\", \"D\""] {
        let found = section(
            markers,
            &format!("p = {{ outline = [{order}], radius = 0.01 }}"),
        );
        assert!(difference(&found, right) < 1e-6, "{found:?}");
        assert!((found.area - right[0]).abs() < 1e-13, "{found:?}");
        assert!((found.second - right[3]).abs() < 1e-15, "{found:?}");
    }
}

#[test]
fn discs_bars_arcs_and_holes_have_the_sections_of_textbooks() {
    use std::f64::consts::PI;
    let (r, x, y) = (0.2, 0.5, -0.3);
    let disc = PI * r * r;
    let at_disc = [
        disc,
        disc * x,
        disc * y,
        disc * (x * x + y * y + 0.5 * r * r),
    ];
    let found = section("P = [0.5, -0.3]", "d = { disc = \"P\", radius = 0.2 }");
    assert!(difference(&found, at_disc) < ROUNDING, "{found:?}");
    // The same disc by two arcs of half a turn.
    let arcs = "d = { outline = [{ marker = \"P\", bulge = 1 }, { marker = \"Q\", bulge = 1 }] }";
    let found = section("P = [0.3, -0.3], Q = [0.7, -0.3]", arcs);
    assert!(difference(&found, at_disc) < ROUNDING, "{found:?}");
    // A bar of length L: a rectangle and a disc cut in two.
    let (length, r) = (0.6, 0.05);
    let (plate, ends) = (2.0 * r * length, PI * r * r);
    let half = 0.5 * length;
    // Half a disc about the centre of its circle, moved from there to the bar's end.
    let of_ends = ends * (half * half + 0.5 * r * r) + 2.0 * half * (4.0 * r / (3.0 * PI)) * ends;
    let of_plate = plate * (length * length + 4.0 * r * r) / 12.0;
    let right = [plate + ends, 0.0, 0.0, of_plate + of_ends];
    let found = section(
        "P = [-0.3, 0], Q = [0.3, 0]",
        "b = { bar = [\"P\", \"Q\"], radius = 0.05 }",
    );
    assert!(difference(&found, right) < ROUNDING, "{found:?}");
    let ring = "d = { disc = \"P\", radius = 0.2 }\nh = { hole = \"P\", radius = 0.1 }";
    let found = section("P = [0, 0]", ring);
    let right = [PI * 0.03, 0.0, 0.0, 0.5 * PI * (1.6e-3 - 1e-4)];
    assert!(difference(&found, right) < ROUNDING, "{found:?}");
}

#[test]
fn fillets_and_rims_take_and_give_what_corners_do() {
    use std::f64::consts::PI;
    let square = "A = [0, 0], B = [1, 0], C = [1, 1], D = [0, 1]";
    let four = "outline = [\"A\", \"B\", \"C\", \"D\"]";
    let found = section(square, &format!("s = {{ {four}, fillet = 0.2 }}"));
    assert!(
        (found.area - (1.0 - (4.0 - PI) * 0.04)).abs() < ROUNDING,
        "{found:?}"
    );
    let found = section(
        square,
        &format!("s = {{ {four}, fillet = 0.2, radius = 0.1 }}"),
    );
    assert!(
        (found.area - (1.44 - (4.0 - PI) * 0.09)).abs() < ROUNDING,
        "{found:?}"
    );
    // A hollow corner stays sharp; an extra corner on an edge changes nothing.
    let corner = "A = [0, 0], B = [1, 0], C = [1, 0.5], D = [0.5, 0.5], E = [0.5, 1], F = [0, 1], M = [0.4, 0]";
    for markers in ["\"A\", \"B\"", "\"A\", \"M\", \"B\""] {
        let outline = format!("outline = [{markers}, \"C\", \"D\", \"E\", \"F\"]");
        let found = section(corner, &format!("s = {{ {outline}, fillet = 0.1 }}"));
        assert!(
            (found.area - (0.75 - 5.0 * (1.0 - PI / 4.0) * 0.01)).abs() < ROUNDING,
            "{found:?}"
        );
        let found = section(corner, &format!("s = {{ {outline}, radius = 0.1 }}"));
        let rim = 0.4 - 0.01 + 5.0 * PI / 4.0 * 0.01;
        assert!((found.area - (0.75 + rim)).abs() < ROUNDING, "{found:?}");
    }
    // Half a disc, its two corners rounded: by similar triangles their centres are at (±√(1 − 2f), f).
    let f: f64 = 0.2;
    let half = "h = { outline = [\"A\", { marker = \"B\", bulge = 1 }], fillet = 0.2 }";
    let found = section("A = [-1, 0], B = [1, 0]", half);
    let x = (1.0 - 2.0 * f).sqrt();
    let lean = f.atan2(x);
    // The sector of the large circle, the triangles below, and two sectors of the fillets.
    let large = 0.5 * (PI - 2.0 * lean);
    let triangles = x * f;
    let small = f * f * 0.5 * (PI / 2.0 + lean);
    assert!(
        (found.area - (large + triangles + 2.0 * small)).abs() < 1e-13,
        "{found:?}"
    );
}

#[test]
fn mass_center_and_inertia_follow_parameters() {
    let text = |r: &str| {
        format!(
            "thickness = \"plate\"\ndensity = 7850\n[bodies.a.shapes]\n\
             bar = {{ bar = [\"O\", \"B\"], radius = {r} }}\nbore = {{ hole = \"O\", radius = \"0.3*r\" }}\n\
             [parameters]\nr = 0.02\nplate = 0.01\nx = 0.3"
        )
    };
    let mechanism =
        read("O = [0, 0], B = [\"x\", \"0.1*x\"]", &text("\"r\"")).expect("it is right");
    let body = BodyId(0);
    let at = |values: [f64; 3]| {
        let weight = mechanism.weight(body, &|id: ParameterId| values[id.index()]);
        let weight = weight.expect("it has a density");
        [
            weight.mass,
            weight.center[0],
            weight.center[1],
            weight.inertia,
        ]
    };
    let values = [0.02, 0.01, 0.3];
    for k in 0..3 {
        let dual = mechanism
            .weight(body, &|id: ParameterId| {
                let slope = f64::from(u8::from(id.index() == k));
                Dual::new(values[id.index()], [slope])
            })
            .expect("it has a density");
        let slopes = [dual.mass, dual.center[0], dual.center[1], dual.inertia].map(|n| n.first());
        let h = 1e-4 * values[k];
        let moved = |by: f64| {
            let mut moved = values;
            moved[k] += by;
            at(moved)
        };
        let (up, down) = (moved(h), moved(-h));
        for (i, slope) in slopes.into_iter().enumerate() {
            let difference = (up[i] - down[i]) / (2.0 * h);
            // The truncation error of the difference is h² of the size.
            let size = difference.abs().max(at(values)[i].abs());
            assert!(
                (slope - difference).abs() < 1e-6 * size,
                "{k} {i}: {slope} {difference}"
            );
        }
    }
}

#[test]
fn outlines_that_enclose_no_area_are_told() {
    let fault = |markers: &str, shapes: &str| {
        read(
            &format!("O = [0, 0], {markers}"),
            &format!("[bodies.a.shapes]\n{shapes}"),
        )
        .expect_err("it is wrong")
    };
    let square = "A = [0, 0], B = [1, 0], C = [1, 1], D = [0, 1], A2 = [0.5, 0]";
    for (markers, shapes, message) in [
        (
            square,
            "s = { outline = [\"A\", \"C\", \"B\", \"D\"] }",
            "its outline crosses itself",
        ),
        (
            square,
            "s = { outline = [\"A\", \"B\", \"C\", \"D\"], fillet = 0.6 }",
            "leaves nothing of the edge behind",
        ),
        (
            square,
            "s = { outline = [\"A\", \"B\", \"A\"] }",
            "at the same place as `A`",
        ),
        (
            square,
            "s = { outline = [\"A\", \"B\", \"A2\"] }",
            "turns back on itself",
        ),
        (
            square,
            "s = { bar = [\"A\", \"O\"], radius = 1 }",
            "at the same place as `A`",
        ),
        (
            square,
            "s = { disc = \"A\", radius = 0 }",
            "must be positive",
        ),
        (
            square,
            "s = { disc = \"X\", radius = 1 }",
            "no marker `X` on `a`",
        ),
        (
            square,
            "s = { disc = \"ground.O\", radius = 1 }",
            "its own body: `O`",
        ),
        (
            square,
            "s = { disc = \"A\", radius = 1, fillet = 1 }",
            "unknown key `fillet`",
        ),
        (square, "s = { radius = 1 }", "none of `disc`"),
        (
            square,
            "s = { disc = \"A\", hole = \"A\", radius = 1 }",
            "both a `disc` and a `hole`",
        ),
        (
            square,
            "A = { disc = \"A\", radius = 1 }",
            "the name of a marker",
        ),
        (
            square,
            "s = { hole = \"A\", radius = 1 }",
            "does not lie within",
        ),
        (
            square,
            "s = { disc = \"A\", radius = 1 }\nh = { hole = \"B\", radius = 0.2 }",
            "does not lie within",
        ),
        (
            square,
            "s = { disc = \"A\", radius = 1, density = 1 }",
            "no `thickness`",
        ),
        (
            square,
            "s = { outline = [\"A\", \"B\"] }",
            "too few markers in `outline` of shape `a.s`: 2, at least 3",
        ),
        (
            square,
            "s = { bar = [\"A\", \"B\", \"D\"], radius = 1.2 }",
            "leaves nothing of the edge",
        ),
    ] {
        let told = fault(markers, shapes);
        assert!(told.contains(message), "{shapes}: {told}");
    }
    let both = read(
        "O = [0, 0]",
        "mass = 1\nthickness = 1\ndensity = 1\nshapes.s = { disc = \"O\", radius = 1 }",
    );
    assert!(
        both.expect_err("it is wrong")
            .contains("has both `mass` and shapes")
    );
}
