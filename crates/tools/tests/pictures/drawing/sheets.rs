//! Pictures are whole: their labels, their size, their formats.

use biela_tools::drawing::{Scene, Sheet, png, svg};

use crate::common::{assembled, folder, parse, shipped, stems};
use crate::drawing::pictures::{WIDTH, check_apart, check_picture, picture};
use crate::generated::{Ground, chain};

#[test]
fn pictures_are_whole_and_labels_apart() {
    for name in stems("mechanisms", "toml") {
        let labels = check_picture(&name, &picture(&name));
        let mechanism = shipped(&name);
        let bodies = mechanism.bodies.iter().map(|body| &body.name);
        let drivers = mechanism.drivers.iter().map(|driver| &driver.name);
        for wanted in bodies.chain(drivers) {
            assert!(
                labels.iter().any(|label| label.text == *wanted),
                "{name}: {wanted}"
            );
        }
        check_apart(&name, &labels);
    }
}

#[test]
fn large_and_small_mechanisms_look_alike() {
    let text = std::fs::read_to_string(folder("mechanisms/pendulum.toml")).expect("it is shipped");
    assert!(text.contains("value = 0.5") && text.contains("[0.1, -0.2"));
    let large = text
        .replace("value = 0.5", "value = 500")
        .replace("[0.1, -0.2", "[100, -200");
    let draw = |text: &str| {
        let (mut solver, _) = assembled(&parse(text));
        let scene = Scene::new(&mut solver, true);
        svg::write(&Sheet::new(&scene, &solver.pose().q), WIDTH, false)
    };
    let (small, large) = (draw(&text), draw(&large));
    // The two lengths have units of different width.
    let body = |svg: &str| svg[..svg.rfind("<text").expect("the scale is last")].to_owned();
    assert_eq!(body(&small), body(&large));
    assert!(small.contains(">200 mm<") && large.contains(">200 m<"));
}

#[test]
fn pngs_have_their_size_and_are_the_same_each_time() {
    let (mut solver, _) = assembled(&shipped("four_bar"));
    let scene = Scene::new(&mut solver, true);
    let sheet = Sheet::new(&scene, &solver.pose().q);
    let picture = png::write(&sheet, 320, false).expect("it has a size");
    assert_eq!(&picture[..8], b"\x89PNG\r\n\x1a\n");
    let width = u32::from_be_bytes(picture[16..20].try_into().expect("four bytes"));
    assert_eq!(width, 320);
    assert!(picture == png::write(&sheet, 320, false).expect("it has a size"));
    assert!(picture != png::write(&sheet, 320, true).expect("it has a size"));
    assert_eq!(png::write(&sheet, 0, false), None);
    assert_eq!(png::write(&sheet, png::MOST_PIXELS + 1, false), None);
}

/// A row of bars on pins, the first driven, each turning with the one before.
fn row(count: usize) -> String {
    let mut ground = String::from("[ground.markers]\n");
    let mut rest = String::new();
    for k in 0..count {
        ground += &format!("O{k} = [{}, 0]\n", 0.2 * k as f64);
        rest += &format!(
            "[bodies.b{k}]\nmarkers = {{ O = [0, 0], A = [0.1, 0] }}\n\
             [joints.j{k}]\ntype = 'revolute'\nmarkers = ['ground.O{k}', 'b{k}.O']\n"
        );
        if let Some(before) = k.checked_sub(1) {
            rest += &format!(
                "[constraints.c{k}]\ncoordinate = 'angle'\n\
                 markers = ['b{before}.O', 'b{k}.O']\nvalue = 0\n"
            );
        }
    }
    format!(
        "format = 1\nname = 'row'\n{ground}{rest}[drivers.d]\ncoordinate = 'angle'\n\
         markers = ['ground.O0', 'b0.O']\nstart = 0.3\n"
    )
}

#[test]
fn the_names_of_very_many_bodies_are_left_out() {
    for (count, named) in [(60, true), (61, false)] {
        let (mut solver, _) = assembled(&parse(&row(count)));
        let scene = Scene::new(&mut solver, false);
        let picture = svg::write(&Sheet::new(&scene, &solver.pose().q), WIDTH, false);
        assert_eq!(picture.contains(">b59<"), named, "{count}");
        assert!(picture.contains(">d<"));
        check_apart("row", &check_picture("row", &picture));
    }
}

#[test]
fn long_chains_get_room_for_their_bars_and_names() {
    let (mut solver, _) = assembled(&parse(&chain(20, Ground::Straight)));
    let scene = Scene::new(&mut solver, false);
    let sheet = Sheet::new(&scene, &solver.pose().q);
    assert!(sheet.width() > WIDTH, "{}", sheet.width());
    let picture = svg::write(&sheet, sheet.width(), false);
    let labels = check_picture("chain", &picture);
    check_apart("chain", &labels);
    for body in &solver.mechanism().bodies {
        assert!(labels.iter().any(|l| l.text == body.name), "{}", body.name);
    }
    // Without room the names of bodies give way, not that of the driver.
    let sheet = Sheet::small(&scene, &solver.pose().q);
    let labels = check_picture("chain", &svg::write(&sheet, sheet.width(), false));
    check_apart("chain", &labels);
    assert!(labels.iter().any(|label| label.text == "crank_angle"));
    // A mechanism of few bodies needs no more than usual.
    let (mut solver, _) = assembled(&shipped("four_bar"));
    let scene = Scene::new(&mut solver, false);
    assert_eq!(Sheet::new(&scene, &solver.pose().q).width(), WIDTH);
}
