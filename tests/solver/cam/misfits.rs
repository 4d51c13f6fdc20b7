//! Contours that a follower cannot follow, and wheels that do not fit.

use biela::kinematics::GeometryWarningKind;

use crate::cam::with_profile;
use crate::common::{assembled, parse, shipped};

/// At θ = 60° of R = 0.05 + 0.01 cos 3θ the contour is hollow: R = 0.04, R″ = 0.09, so that the
/// curvature (R² − R R″)/R³ is −31.25/m and the radius of curvature 32 mm.
#[test]
fn a_roller_too_large_for_a_hollow_is_reported() {
    for (roller, fits) in [(0.0319, true), (0.0321, false)] {
        let mut solver = with_profile("cam_roller", "'0.05 + 0.01*cos(3*theta)'");
        let mechanism = solver.mechanism().clone();
        let mut path = biela::kinematics::Path::new(&mechanism);
        let radius = mechanism.parameter_id("roller_radius").expect("it has one");
        path.to[radius.index()] = roller;
        solver.assemble(&path).expect("it closes");
        match &solver.geometry_warnings()[..] {
            [] => assert!(fits),
            [misfit] => {
                assert!(!fits);
                let GeometryWarningKind::NarrowHollow {
                    ranges, curvature, ..
                } = &misfit.kind
                else {
                    panic!("{misfit}");
                };
                assert!((curvature - 0.032).abs() < 1e-9);
                // The three hollows, to the parts of a degree that are looked at.
                let middles = ranges
                    .iter()
                    .map(|[from, to]| (0.5 * (from + to)).to_degrees());
                let middles: Vec<_> = middles.map(|middle| middle.round()).collect();
                assert_eq!(middles, [60.0, 180.0, 300.0]);
            }
            more => panic!("{more:?}"),
        }
    }
}

/// R = 0.05 + 0.005 cos 3θ turns hollow where R² + 2R′² − R R″ = 0; at θ = 60° it is
/// 0.045² − 0.045·0.045 = 0 exactly: convex up to an amplitude of 5 mm.
#[test]
fn a_flat_face_over_a_hollow_is_reported() {
    for (amplitude, hollow) in [("0.0049", false), ("0.0051", true)] {
        let profile = format!("'0.05 + {amplitude}*cos(3*theta)'");
        let misfits = with_profile("cam_flat", &profile).geometry_warnings();
        let reported = misfits
            .iter()
            .any(|misfit| matches!(misfit.kind, GeometryWarningKind::HollowUnderFace { .. }));
        assert_eq!(
            (reported, misfits.len()),
            (hollow, usize::from(hollow)),
            "{misfits:?}"
        );
    }
}

#[test]
fn the_gallery_fits() {
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/mechanisms"))
        .expect("the folder is there")
    {
        let path = entry.expect("it can be read").path();
        if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            let name = path.file_stem().expect("it has a name").to_string_lossy();
            let misfits = assembled(&shipped(&name)).0.geometry_warnings();
            assert!(misfits.is_empty(), "{name}: {misfits:?}");
        }
    }
}

/// Gears, belts and racks whose places do not fit their radii, each with the figures.
#[test]
fn wheels_that_do_not_fit_are_reported() {
    let pair = |joint: &str| {
        let mechanism = parse(&format!(
            "format = 1\nname = 'pair'\n[ground.markers]\nA = [0, 0]\nB = [0.3, 0.4]\n\
             [bodies.a]\nmarkers = {{ O = [0, 0] }}\n[bodies.b]\nmarkers = {{ O = [0, 0] }}\n\
             estimate = [0.3, 0.4, 0]\n[joints]\n\
             A = {{ type = 'revolute', markers = ['ground.A', 'a.O'] }}\n\
             B = {{ type = 'revolute', markers = ['ground.B', 'b.O'] }}\n{joint}\n[drivers]\n\
             u = {{ coordinate = 'angle', markers = ['ground.A', 'a.O'], start = 0 }}\n"
        ));
        let misfits = assembled(&mechanism).0.geometry_warnings();
        misfits.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let wheels = |kind: &str, radii: &str, more: &str| {
        pair(&format!(
            "W = {{ type = '{kind}', markers = ['a.O', 'b.O'], radii = {radii}{more} }}"
        ))
    };
    let fits: [String; 0] = [];
    assert_eq!(wheels("gear", "[0.2, 0.3]", ""), fits);
    assert_eq!(wheels("gear", "[0.7, 0.2]", ", internal = true"), fits);
    assert_eq!(
        wheels("gear", "[0.2, 0.31]", ""),
        ["joint `W`: the centres are 0.500000 m apart; the radii ask for 0.510000 m"]
    );
    assert_eq!(
        wheels("gear", "[0.2, 0.3]", ", internal = true"),
        ["joint `W`: the centres are 0.500000 m apart; the radii ask for 0.100000 m"]
    );
    assert_eq!(wheels("belt", "[0.2, 0.6]", ""), fits);
    assert_eq!(
        wheels("belt", "[0.2, 0.4]", ", crossed = true"),
        [
            "joint `W`: the centres are 0.500000 m apart; wheels of these radii need more than \
             0.600000 m"
        ]
    );
    let rack = |side: &str| {
        let mechanism = parse(&format!(
            "format = 1\nname = 'rack'\n[ground.markers]\nO = [0, 0.05]\nway = [0, 0]\n\
             [bodies.pinion]\nmarkers = {{ O = [0, 0] }}\n[bodies.rack]\nmarkers = {{ R = [0, 0] }}\n\
             [joints]\nO = {{ type = 'revolute', markers = ['ground.O', 'pinion.O'] }}\n\
             way = {{ type = 'translational', markers = ['ground.way', 'rack.R'] }}\n\
             W = {{ type = 'rack_and_pinion', markers = ['pinion.O', 'rack.R'], radius = 0.05, side = '{side}' }}\n\
             [drivers]\nu = {{ coordinate = 'angle', markers = ['ground.O', 'pinion.O'], start = 0 }}\n"
        ));
        let misfits = assembled(&mechanism).0.geometry_warnings();
        misfits.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(rack("above"), fits);
    assert_eq!(
        rack("below"),
        [
            "joint `W`: the pinion's centre is at y = 0.050000 m of the rack; its radius and \
             side ask for -0.050000 m"
        ]
    );
}
