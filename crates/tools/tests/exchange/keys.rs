//! Each key of each format is taken, noted or refused: with another value the answer is another one.
//! The page on imports has each of them.

use biela_tools::exchange::Format;

use crate::common::folder;

/// A key with the text of its file, and another text in its place.
type Key<'a> = (&'a str, &'a str, &'a str);

/// Returns the mechanism file with its notes, or the error.
fn answer(format: Format, text: &str) -> String {
    match format.read(text.as_bytes(), "it", None) {
        Ok(draft) => draft.write("it"),
        Err(error) => format!("error: {error}"),
    }
}

/// Returns the part of the page on imports below a heading.
fn page(heading: &str) -> String {
    let page = std::fs::read_to_string(folder("docs/import.md")).expect("it is there");
    let start = page.find(&format!("\n## {heading}\n")).expect("it has it") + 4;
    let rest = &page[start..];
    rest[..rest.find("\n## ").unwrap_or(rest.len())].to_owned()
}

fn sample(path: &str) -> String {
    let path = folder("crates/tools/tests/exchange/samples").join(path);
    std::fs::read_to_string(path).expect("it is part of the project")
}

/// Changes each key in turn.
fn walk(format: Format, heading: &str, base: &str, keys: &[Key]) {
    let before = answer(format, base);
    assert!(!before.starts_with("error"), "{before}");
    let page = page(heading);
    for (key, from, to) in keys {
        assert!(base.contains(from), "{key}: `{from}` is not in the file");
        let after = answer(format, &base.replacen(from, to, 1));
        assert_ne!(before, after, "`{key}` is neither taken, noted nor refused");
        assert!(
            page.contains(&format!("`{key}`")),
            "the page does not have `{key}`"
        );
    }
}

#[test]
fn keys_of_linkage_are_taken_noted_or_refused() {
    let base = r#"<linkage2>
<program units="Millimeters"/>
<connector id="0" x="0" y="0" anchor="true" input="true" rpm="15"/>
<connector id="1" x="75" y="130"/>
<connector id="2" x="412" y="302"/>
<connector id="3" x="415" y="0" anchor="true"/>
<connector id="4" x="600" y="0" anchor="true"/>
<connector id="5" x="800" y="100"/>
<connector id="6" x="700" y="50" slider="true"><slidelimit id="4"/><slidelimit id="7"/></connector>
<connector id="7" x="900" y="150" anchor="true"/>
<connector id="8" x="700" y="400"/>
<connector id="9" x="0" y="-400" anchor="true"/>
<Link id="0" name="crank"><connector id="0"/><connector id="1"/></Link>
<Link id="1"><connector id="1"/><connector id="2"/></Link>
<Link id="2"><connector id="2"/><connector id="3"/></Link>
<Link id="3"><connector id="6"/><connector id="8"/></Link>
<Link id="4"><connector id="2"/><connector id="5"/></Link>
<Link id="5" actuator="true" throw="20" cpm="5"><connector id="5"/><connector id="8"/></Link>
<Link id="6" gear="true"><connector id="0"/></Link>
<Link id="7" gear="true"><connector id="9"/></Link>
<ratios><ratio type="gears"><link id="6" size="1"/><link id="7" size="2"/></ratio></ratios>
</linkage2>"#;
    let program = "units=\"Millimeters\"";
    let connector = "id=\"1\" x=\"75\"";
    let link = "<Link id=\"1\"";
    let mut keys: Vec<Key> = vec![
        ("units", "Millimeters", "Inches"),
        ("x", "x=\"75\"", "x=\"76\""),
        ("y", "y=\"130\"", "y=\"131\""),
        ("id", "<connector id=\"2\"/>", "<connector id=\"3\"/>"),
        (
            "anchor",
            "x=\"415\" y=\"0\" anchor=\"true\"",
            "x=\"415\" y=\"0\"",
        ),
        ("input", "input=\"true\"", "input=\"false\""),
        ("rpm", "rpm=\"15\"", "rpm=\"-15\""),
        ("limitangle", "rpm=\"15\"", "rpm=\"15\" limitangle=\"30\""),
        ("startoffset", "rpm=\"15\"", "rpm=\"15\" startoffset=\"30\""),
        ("startoffset", "cpm=\"5\"", "cpm=\"5\" startoffset=\"3\""),
        (
            "alwaysmanual",
            "rpm=\"15\"",
            "rpm=\"15\" alwaysmanual=\"true\"",
        ),
        ("slider", "slider=\"true\"", "slider=\"false\""),
        (
            "slidelimit",
            "<slidelimit id=\"7\"/>",
            "<slidelimit id=\"3\"/>",
        ),
        (
            "slideradius",
            "slider=\"true\"",
            "slider=\"true\" slideradius=\"-400\"",
        ),
        ("connector", "<connector id=\"5\"/></Link>", "</Link>"),
        (
            "element",
            "<Link id=\"2\"><connector id=\"2\"/><connector id=\"3\"/></Link>",
            "",
        ),
        (
            "Link",
            "<Link id=\"2\"><connector id=\"2\"/><connector id=\"3\"/></Link>",
            "",
        ),
        ("actuator", "actuator=\"true\"", "actuator=\"false\""),
        ("throw", "throw=\"20\"", "throw=\"30\""),
        ("cpm", "cpm=\"5\"", "cpm=\"-5\""),
        ("gear", "gear=\"true\"", "gear=\"true\" solid=\"true\""),
        ("name", "name=\"crank\"", "name=\"arm\""),
        (
            "ratios",
            "<ratios>",
            "<ratios><ratio type=\"chain\"><link id=\"6\" size=\"1\"/><link id=\"7\" size=\"1\"/></ratio>",
        ),
        (
            "ratio",
            "<ratio type=\"gears\"><link id=\"6\" size=\"1\"/><link id=\"7\" size=\"2\"/></ratio>",
            "",
        ),
        ("type", "gears", "chain"),
        (
            "sizeassize",
            "type=\"gears\"",
            "type=\"gears\" sizeassize=\"true\"",
        ),
        ("size", "size=\"2\"", "size=\"3\""),
        ("link", "<link id=\"7\" size=\"2\"/>", ""),
        (
            "background",
            "<ratios>",
            "<background filename=\"a\"/><ratios>",
        ),
        (
            "selected",
            "<ratios>",
            "<selected><connector id=\"1\"/></selected><ratios>",
        ),
    ];
    let added: Vec<(&str, &str, String)> = [
        ("program", "zoom"),
        ("program", "xoffset"),
        ("program", "yoffset"),
        ("program", "scalefactor"),
        ("program", "viewlayers"),
        ("program", "editlayers"),
        ("connector", "draw"),
        ("connector", "drawcircle"),
        ("connector", "fastenlink"),
        ("connector", "fastenconnector"),
        ("connector", "layer"),
        ("connector", "color"),
        ("connector", "usercolor"),
        ("connector", "linesize"),
        ("connector", "shape"),
        ("connector", "labels"),
        ("connector", "angles"),
        ("connector", "unheard_of"),
        ("link", "fastenlink"),
        ("link", "fastenconnector"),
        ("link", "measurementelement"),
        ("link", "layer"),
        ("link", "solid"),
        ("link", "locked"),
        ("link", "color"),
        ("link", "usercolor"),
        ("link", "linesize"),
        ("link", "shape"),
        ("link", "labels"),
        ("link", "angles"),
        ("link", "measurementline"),
        ("link", "unheard_of"),
    ]
    .into_iter()
    .map(|(place, key)| {
        let before = match place {
            "program" => program,
            "connector" => connector,
            _ => link,
        };
        let value = match key {
            "layer" => "1",
            "fastenlink" => "4",
            "fastenconnector" => "3",
            "draw" | "measurementelement" | "solid" | "locked" | "drawcircle" => "true",
            _ => "7",
        };
        (key, before, format!("{before} {key}=\"{value}\""))
    })
    .collect();
    keys.extend(
        added
            .iter()
            .filter(|(key, ..)| *key != "unheard_of" && *key != "layer")
            .map(|(key, from, to)| (*key, *from, &**to)),
    );
    walk(Format::Linkage, "Linkage", base, &keys);
    // Points of a mechanism on the layer of drawings stay its points; its links do not.
    let before = answer(Format::Linkage, base);
    for (key, from, to) in added
        .iter()
        .filter(|(key, ..)| *key == "layer" || *key == "unheard_of")
    {
        let after = answer(Format::Linkage, &base.replacen(from, to, 1));
        let is_point = *key == "layer" && from.starts_with("id");
        assert_eq!(before == after, is_point, "{key}");
    }
    assert!(page("Linkage").contains("`layer`"));
}

#[test]
fn keys_of_assemblies_are_taken_noted_or_refused() {
    let base = sample("asmt/thrown_pendulum.asmt");
    let second = "\t\t\tRevoluteJoint\n\t\t\t\tName\n\t\t\t\t\tsecond\n\t\t\t\tMarkerI\n\t\t\t\t\t\
        /Own/rod/Tip\n\t\t\t\tMarkerJ\n\t\t\t\t\t/Own/O\n";
    let joint = "\t\t\tRevoluteJoint\n";
    let with = |line: &str, value: &str| format!("\t\t{line}\n\t\t\t\t\t{value}\n");
    let motion = |class: &str, key: &str, value: &str| {
        format!(
            "\t\tMotions\n\t\t\t{class}\n\t\t\t\tName\n\t\t\t\t\tm\n\t\t\t\tMotionJoint\n\
             \t\t\t\t\t/Own/pin\n\t\t\t\t{key}\n\t\t\t\t\t{value}\n"
        )
    };
    let limit = "\t\tLimits\n\t\t\tRotationLimit\n\t\t\t\tName\n\t\t\t\t\tl\n\t\t\t\tMotionJoint\n\
        \t\t\t\t\t/Own/pin\n\t\t\t\tLimit\n\t\t\t\t\t1\n\t\t\t\tType\n\t\t\t\t\t=<\n\
        \t\t\t\tTol\n\t\t\t\t\t1e-9\n\t\tGeneralConstraintSets\n";
    let force = |class: &str, keys: &str| {
        format!(
            "\tForceTorques\n\t\t{class}\n\t\t\tName\n\t\t\t\tf\n\t\t\tMarkerI\n\t\t\t\t/Own/rod/Tip\n\
             \t\t\tMarkerJ\n\t\t\t\t/Own/O\n{keys}"
        )
    };
    let general = |key: &str| {
        let zero = ["FxOnI", "FyOnI", "FzOnI", "TxOnI", "TyOnI", "TzOnI"].map(|known| {
            let value = if known == key { "2*time" } else { "0" };
            format!("\t\t\t{known}\n\t\t\t\t{value}\n")
        });
        let axes = if key == "MarkerK" { "J" } else { "O" };
        force(
            "GeneralForceTorque",
            &format!("{}\t\t\tMarkerK\n\t\t\t\t{axes}\n", zero.concat()),
        )
    };
    // Classes of joints, with their values.
    let classes = [
        "CylindricalJoint",
        "TranslationalJoint",
        "FixedJoint",
        "SphericalJoint",
        "UniversalJoint",
        "PointInLineJoint",
        "ParallelAxesJoint",
        "PerpendicularJoint",
        "NoRotationJoint",
        "ConstantVelocityJoint",
    ];
    let mut keys: Vec<(&str, String, String)> = Vec::new();
    let swap = |key: &'static str, from: &str, to: &str| (key, from.to_owned(), to.to_owned());
    let doubled = base.replacen(joint, &format!("{second}{joint}"), 1);
    for class in classes {
        let other = second.replace("RevoluteJoint", class);
        keys.push((
            class,
            "\t\tJoints\n".to_owned(),
            format!("\t\tJoints\n{other}"),
        ));
    }
    for (class, values) in [
        ("GearJoint", &["radiusI", "radiusJ"][..]),
        ("RackPinionJoint", &["pitchRadius"]),
        ("ScrewJoint", &["pitch"]),
        ("AngleJoint", &["theIzJz"]),
        ("SphSphJoint", &["distanceIJ"]),
        ("CylSphJoint", &["distanceIJ"]),
        ("RevCylJoint", &["distanceIJ"]),
        ("RevRevJoint", &["distanceIJ"]),
        ("PlanarJoint", &["offset"]),
        ("PointInPlaneJoint", &["offset"]),
        ("LineInPlaneJoint", &["offset"]),
    ] {
        let values: String = values
            .iter()
            .map(|key| with(&format!("\t\t{key}"), "0.5"))
            .collect();
        let other = second.replace("RevoluteJoint", class);
        keys.push((
            class,
            "\t\tJoints\n".to_owned(),
            format!("\t\tJoints\n{other}{values}"),
        ));
    }
    keys.extend([
        swap("Name", "\t\tOwn\n", "\t\tAssembly1\n"),
        swap(
            "Notes",
            "\tNotes\n\t\t(Text string: 'own' runs: (Core.RunArray runs: #() values: #()))\n",
            "",
        ),
        swap("Position3D", "0.5\t0.0\t0.0", "0.6\t0.0\t0.0"),
        swap(
            "RotationMatrix",
            "-0.479425538604203\t0.8775825618903728",
            "0.479425538604203\t0.8775825618903728",
        ),
        swap(
            "Velocity3D",
            "0.0\n\t\t\tOmega3D",
            "0.0\n\t\t\tUnheardOf\n\t\t\t\t1.0\n\t\t\tOmega3D",
        ),
        swap("Omega3D", "0.0\t0.0\t3.0", "0.0\t0.0\t2.0"),
        swap(
            "PrincipalMassMarker",
            "\t\t\tPrincipalMassMarker\n",
            "\t\t\tPrincipalMass\n",
        ),
        swap("Mass", "\t\t\t\t\t2.0\n", "\t\t\t\t\t3.0\n"),
        swap("MomentOfInertias", "0.001\t0.17\t0.17", "0.001\t0.17\t0.18"),
        swap("Density", "\t\t\t\tDensity\n\t\t\t\t\t10.0\n", ""),
        swap(
            "FeatureOrder",
            "\t\t\tFeatureOrder\n",
            "\t\t\tFeatureOrder\n\t\t\t\tExtrusion\n",
        ),
        swap("RefCurves", "\tRefCurves\n", "\tRefCurves\n\t\tRefCurve\n"),
        swap(
            "RefSurfaces",
            "\tRefSurfaces\n",
            "\tRefSurfaces\n\t\tRefSurface\n",
        ),
        swap(
            "KinematicIJs",
            "\tKinematicIJs\n",
            "\tKinematicIJs\n\t\tKinematicIJ\n",
        ),
        swap(
            "GeneralConstraintSets",
            "\t\tGeneralConstraintSets\n",
            "\t\tGeneralConstraintSets\n\t\t\tSet\n",
        ),
        swap("ConstantGravity", "0.0\t-9.81\t0.0", "0.0\t-1.62\t0.0"),
        swap("tstart", "\t\ttstart\n\t\t\t0.0", "\t\ttstart\n\t\t\t0.5"),
        swap("tend", "\t\ttend\n\t\t\t2.0", "\t\ttend\n\t\t\t3.0"),
        swap("hout", "\t\thout\n\t\t\t0.01", "\t\thout\n\t\t\t0.02"),
        swap("hmin", "\t\thmin\n\t\t\t1.0e-9\n", ""),
        swap("hmax", "\t\thmax\n\t\t\t1.0\n", ""),
        swap("errorTol", "\t\terrorTol\n\t\t\t1.0e-6\n", ""),
        swap(
            "AnimationParameters",
            "\tAnimationParameters\n",
            "\tUnheardOf\n",
        ),
        swap(
            "MarkerI",
            "MarkerI\n\t\t\t\t\t/Own/O",
            "MarkerI\n\t\t\t\t\t/Own/P",
        ),
        swap(
            "MarkerJ",
            "MarkerJ\n\t\t\t\t\t/Own/rod/A",
            "MarkerJ\n\t\t\t\t\t/Own/rod/Tip",
        ),
        swap("RotationLimit", "\t\tGeneralConstraintSets\n", limit),
        swap(
            "TranslationLimit",
            "\t\tGeneralConstraintSets\n",
            &limit.replace("Rotation", "Translation"),
        ),
        swap("Tol", "\t\tGeneralConstraintSets\n", limit),
    ]);
    for key in [
        "errorTolPosKine",
        "errorTolAccKine",
        "iterMaxPosKine",
        "iterMaxAccKine",
        "corAbsTol",
        "corRelTol",
    ] {
        let known = "\t\thmax\n\t\t\t1.0\n";
        keys.push((
            key,
            known.to_owned(),
            format!("{known}\t\t{key}\n\t\t\t1.0\n"),
        ));
    }
    for (class, key, value) in [
        ("RotationalMotion", "RotationZ", "2*time"),
        ("TranslationalMotion", "TranslationZ", "2*time"),
        ("GeneralMotion", "rIJI1", "0"),
        ("AllowRotation", "RotationZ", "0"),
    ] {
        keys.push((class, "\t\tMotions\n".to_owned(), motion(class, key, value)));
    }
    let line = "\t\t\ttension\n\t\t\t\t3*rIJ(self)\n\t\t\ttwist\n\t\t\t\t0\n";
    let forces = [
        ("InLineForceTorque", force("InLineForceTorque", line)),
        (
            "tension",
            force("InLineForceTorque", &line.replace("3*", "4*")),
        ),
        (
            "twist",
            force("InLineForceTorque", &line.replace("\t0\n", "\t1\n")),
        ),
        ("GeneralForceTorque", general("FxOnI")),
        ("FyOnI", general("FyOnI")),
        ("FzOnI", general("FzOnI")),
        ("TxOnI", general("TxOnI")),
        ("TyOnI", general("TyOnI")),
        ("TzOnI", general("TzOnI")),
        ("MarkerK", general("MarkerK")),
        ("ForceTorque", force("ForceTorque", "")),
    ];
    for (key, text) in forces {
        keys.push((key, "\tForceTorques\n".to_owned(), text));
    }
    let keys: Vec<Key> = keys
        .iter()
        .map(|(key, from, to)| (*key, &**from, &**to))
        .collect();
    walk(Format::Asmt, "FreeCAD and OndselSolver", &base, &keys);
    // Values of joints change the answer too, where the joint is not refused for its place.
    let rod = second.replace("RevoluteJoint", "SphSphJoint") + &with("\t\tdistanceIJ", "0.5");
    let text = doubled.replace(second, &rod);
    let longer = text.replace("distanceIJ\n\t\t\t\t\t0.5", "distanceIJ\n\t\t\t\t\t0.6");
    assert_ne!(answer(Format::Asmt, &text), answer(Format::Asmt, &longer));
    let page = page("FreeCAD and OndselSolver");
    let sets = "\t\tGeneralConstraintSets\n";
    let limited = base.replacen(sets, limit, 1);
    for key in ["Behavior", "Stiffness", "Damping"] {
        let more = format!("\t\t\t\t{key}\n\t\t\t\t\t1\n{sets}");
        let changed = limited.replacen(sets, &more, 1);
        assert_ne!(
            answer(Format::Asmt, &limited),
            answer(Format::Asmt, &changed)
        );
        assert!(page.contains(&format!("`{key}`")), "{key}");
    }
    for function in ["spline", "integral", "rampstep", "piecewise", "rIJ", "vrIJ"] {
        assert!(page.contains(&format!("`{function}`")), "{function}");
    }
}

/// Returns a query with its check character.
fn checked(query: &str) -> String {
    let digits = b"0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
    format!("{query}{}", char::from(digits[query.len() % 62]))
}

#[test]
fn fields_of_links_are_taken_noted_or_refused() {
    // A slider–crank, a rod at its end, with a mass and a force.
    let base = "0O.Ti,Fe.K,0.1011.6A,A,0,0,0.0B,B,X9,X9,0.0C,C,2ih,Fe,0.5S,S,2ih,Fe,0.0D,D,Fe,2ih,0..\
        YRAB,AB,Fe,VG,0,0,303e9f,A,B,,.YRBC,BC,Fe,Fe,0,0,303e9f,B,C,D,,.YPCS,CS,Fe,Fe,0,0,303e9f,C,S,,..\
        3F1,BC,F1,VG,s8,ku,s8,CDG..N";
    let keys: [Key; 28] = [
        ("clockwise", "0O", "0P"),
        ("gravity", "0O", "4O"),
        (
            "linear speed",
            "0O.Ti,Fe.K,0.1011.6A",
            "0O.Ti,VG.K,0.1011.6A",
        ),
        ("input speed", "K,0", "L,0"),
        ("unit of length", "1011", "2011"),
        ("unit of force", "1011", "1021"),
        ("prismatic", "5S", "4S"),
        ("input", "6A", "4A"),
        ("grounded", "5S", "1S"),
        ("welded", "0C,C", "8C,C"),
        ("curve", "0D,D", "GD,D"),
        ("id", "B,C,D,", "B,C,E,"),
        ("name", "S,S,", "S,way,"),
        ("x", "Fe,2ih,0..", "Ff,2ih,0.."),
        ("y", "Fe,2ih,0..", "Fe,2ii,0.."),
        ("angle", "2ih,Fe,0.0D", "2ih,Fe,1.0D"),
        ("slot", "2ih,Fe,0.0D", "2ih,Fe,0,AB,A,B.0D"),
        ("own speed", "A,0,0,0.", "A,0,0,0,,,,1z0."),
        ("root", "YRBC", "NRBC"),
        ("block", "YPCS", "YRCS"),
        ("mass", "AB,AB,Fe,VG", "AB,AB,Ff,VG"),
        ("inertia", "AB,AB,Fe,VG", "AB,AB,Fe,VH"),
        ("centre of mass", "AB,AB,Fe,VG,0,0", "AB,AB,Fe,VG,1,0"),
        ("joints", "B,C,D,,", "B,C,,"),
        ("local", "3F1", "2F1"),
        ("outward", "3F1", "1F1"),
        ("size", "CDG", "CDH"),
        ("locks", "..N", "..N.JA,Hl"),
    ];
    let page = page("PMKS+");
    let before = answer(Format::Pmks, &checked(base));
    assert!(before.contains("F1"), "{before}");
    // A driven slider has the linear speed.
    let driven = base.replace("6A,A", "4A,A").replace("5S,S", "7S,S");
    for (key, from, to) in keys {
        let base = if key == "linear speed" {
            driven.replace("4A,A", "6A,A")
        } else {
            base.to_owned()
        };
        let before = answer(Format::Pmks, &checked(&base));
        assert!(base.contains(from), "{key}: `{from}`");
        let after = answer(Format::Pmks, &checked(&base.replacen(from, to, 1)));
        assert_ne!(before, after, "`{key}` is neither taken, noted nor refused");
        assert!(page.contains(key), "the page does not have {key}");
    }
    // Parts of links, and letters of today's links.
    for letter in "YAMG0123".chars() {
        let text = base.replace("YRBC", &format!("{letter}RBC"));
        assert_eq!(answer(Format::Pmks, &checked(&text)), before, "{letter}");
    }
    for letter in "NamgXy8".chars() {
        let text = base.replace("YRBC", &format!("{letter}RBC"));
        assert_ne!(answer(Format::Pmks, &checked(&text)), before, "{letter}");
    }
    // Digits behind the star prove the link in a way that is not known.
    assert_eq!(answer(Format::Pmks, &format!("{base}*aB3_-")), before);
}

#[test]
fn keys_of_pylinkage_are_taken_noted_or_refused() {
    let base = r#"{"name": "it", "ground": "g", "joints": [
        {"id": "A", "type": "ground", "position": [0, 0]},
        {"id": "B", "type": "revolute", "position": [20, 34], "name": "B"},
        {"id": "C", "type": "revolute", "position": [109, 80]},
        {"id": "D", "type": "ground", "position": [110, 0]},
        {"id": "S", "type": "prismatic", "position": [200, 50], "axis": [1, 0], "line_point": [0, 50], "slide_distance": 0},
        {"id": "P", "type": "tracker", "position": [50, 84], "ref_joint1_id": "B", "ref_joint2_id": "C", "distance": 58, "angle": 0.5}],
        "links": [{"id": "g", "type": "ground", "joints": ["A", "D"]},
        {"id": "crank", "type": "driver", "joints": ["A", "B"], "motor_joint": "A", "angular_velocity": 0.1, "initial_angle": 1},
        {"id": "rod", "type": "link", "joints": ["B", "C"]},
        {"id": "rocker", "type": "link", "joints": ["C", "D"]},
        {"id": "slide", "type": "link", "joints": ["C", "S"]}]}"#;
    let driver = "\"type\": \"driver\"";
    let arc = "\"type\": \"arc_driver\", \"arc_start\": 0.5, \"arc_end\": 1.5";
    let keys: [Key; 26] = [
        ("name", "\"name\": \"it\"", "\"name\": \"other\""),
        ("ground", "\"ground\": \"g\"", "\"ground\": \"rocker\""),
        ("joints", "[\"B\", \"C\"]", "[\"B\", \"D\"]"),
        (
            "links",
            "{\"id\": \"rocker\", \"type\": \"link\", \"joints\": [\"C\", \"D\"]},",
            "",
        ),
        ("id", "\"id\": \"D\"", "\"id\": \"E\""),
        ("type", "\"type\": \"revolute\"", "\"type\": \"unheard_of\""),
        ("position", "[20, 34]", "[20, 35]"),
        (
            "revolute",
            "\"C\", \"type\": \"revolute\"",
            "\"C\", \"type\": \"Revolute\"",
        ),
        (
            "prismatic",
            "\"type\": \"prismatic\"",
            "\"type\": \"revolute\"",
        ),
        ("axis", "\"axis\": [1, 0]", "\"axis\": [1, 1]"),
        ("line_point", "[0, 50]", "[0, 40]"),
        ("slide_distance", ", \"slide_distance\": 0", ""),
        ("tracker", "\"type\": \"tracker\"", "\"type\": \"revolute\""),
        (
            "ref_joint1_id",
            "\"ref_joint1_id\": \"B\"",
            "\"ref_joint1_id\": \"A\"",
        ),
        (
            "ref_joint2_id",
            "\"ref_joint2_id\": \"C\"",
            "\"ref_joint2_id\": \"D\"",
        ),
        ("distance", "\"distance\": 58, ", ""),
        ("angle", ", \"angle\": 0.5", ""),
        ("driver", driver, "\"type\": \"link\""),
        ("arc_driver", driver, arc),
        ("arc_start", driver, arc),
        ("arc_end", driver, arc),
        (
            "motor_joint",
            "\"motor_joint\": \"A\"",
            "\"motor_joint\": \"B\"",
        ),
        (
            "angular_velocity",
            "\"angular_velocity\": 0.1",
            "\"angular_velocity\": 0",
        ),
        ("initial_angle", ", \"initial_angle\": 1", ""),
        ("hypergraph", "\"ground\": \"g\"", "\"nodes\": []"),
        ("assur", "\"ground\": \"g\"", "\"assur_groups\": []"),
    ];
    walk(Format::Pylinkage, "pylinkage", base, &keys);
    let before = answer(Format::Pylinkage, base);
    let after = answer(
        Format::Pylinkage,
        &base.replace("\"ground\": \"g\"", "\"ground\": \"g\", \"a\": 1"),
    );
    assert_ne!(before, after, "a key that is not known is told");
}
