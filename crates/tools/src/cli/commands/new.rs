//! `biela new`

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::PossibleValuesParser;

use crate::cli::given::assigning::unknown_name;
use crate::cli::results::new_file::{create, exists, tell_now_check};
use crate::cli::told::error::Error;
use biela::mechanism::{is_identifier, similar_identifier};

/// Write a commented mechanism to start from.
///
/// The file is a copy of one of the mechanisms that come with biela, under another name.
#[derive(Args, Debug)]
#[command(after_help = "Example: biela new my_linkage --from four_bar")]
pub(in crate::cli) struct New {
    /// The mechanism's name: letters, digits and `_`. Its file is NAME.toml.
    name: String,
    /// The mechanism to start from.
    #[arg(long, value_name = "MECHANISM", default_value = "four_bar",
        value_parser = PossibleValuesParser::new(TEMPLATES.iter().map(|template| template.name)))]
    from: String,
    /// The folder to write to [default: the current one].
    #[arg(short, long, value_name = "FOLDER")]
    folder: Option<PathBuf>,
}

/// A mechanism to start from.
struct Template {
    name: &'static str,
    text: &'static str,
    /// The tables that it names, with the names of their files.
    tables: &'static [(&'static str, &'static str)],
}

macro_rules! template {
    ($name:literal $(, $table:literal)*) => {
        Template {
            name: $name,
            text: include_str!(concat!("../../../../../mechanisms/", $name, ".toml")),
            tables: &[$(($table, include_str!(concat!("../../../../../mechanisms/", $table)))),*],
        }
    };
}

/// Returns name, text and tables of each mechanism that comes with biela; a table has the name of its
/// file and its content.
pub(in crate::cli) fn templates() -> impl Iterator<
    Item = (
        &'static str,
        &'static str,
        &'static [(&'static str, &'static str)],
    ),
> {
    let templates = TEMPLATES.iter();
    templates.map(|template| (template.name, template.text, template.tables))
}

/// The mechanisms that come with biela.
static TEMPLATES: &[Template] = &[
    template!("andrews"),
    template!("andrews_free"),
    template!("bicycle_suspension"),
    template!("block_and_tackle"),
    template!("bonnet_hinge"),
    template!("cam_flat"),
    template!("cam_flat_arm"),
    template!("cam_knife"),
    template!("cam_knife_arm"),
    template!("cam_points", "cam_points.csv"),
    template!("cam_roller"),
    template!("cam_roller_arm"),
    template!("cart_pole"),
    template!("chebyshev"),
    template!("corexy"),
    template!("double_drawer"),
    template!("double_pendulum"),
    template!("double_rocker"),
    template!("drag_link"),
    template!("elliptic_trammel"),
    template!("engine"),
    template!("engine_free"),
    template!("excavator_arm"),
    template!("five_bar_free"),
    template!("five_bar_robot"),
    template!("four_bar"),
    template!("four_bar_chain"),
    template!("four_bar_free"),
    template!("garage_door_track", "garage_door_track.csv"),
    template!("geared_five_bar"),
    template!("geneva_drive"),
    template!("gripper"),
    template!("groove_cam"),
    template!("hart_inversor"),
    template!("hatch"),
    template!("jansen_leg"),
    template!("latch"),
    template!("loader"),
    template!("pantograph"),
    template!("parallelogram"),
    template!("peaucellier"),
    template!("pendulum"),
    template!("pendulum_free"),
    template!("pick_and_place"),
    template!("planetary_gear"),
    template!("platform_3rpr"),
    template!("rack_drive"),
    template!("rolling_wheel"),
    template!("sash_window"),
    template!("scissor_lift_screw"),
    template!("scotch_yoke"),
    template!("screw_jack"),
    template!("servo_arm"),
    template!("sewing_machine"),
    template!("slider_crank"),
    template!("slider_crank_motor"),
    template!("slotted_lever"),
    template!("stephenson_six_bar"),
    template!("swinging_tip"),
    template!("tlv"),
    template!("tlv_crank"),
    template!("toggle_press"),
    template!("v_twin"),
    template!("valve_train"),
    template!("watt_six_bar"),
    template!("wedge_press"),
    template!("whitworth"),
    template!("wiper"),
    template!("wiper_motor"),
];

impl New {
    pub(in crate::cli) fn run(self) -> Result<(), Error> {
        let folder = self.folder.unwrap_or_default();
        tell_now_check(&write_new(&self.name, &self.from, &folder)?);
        Ok(())
    }
}

/// Writes a copy of a mechanism that comes with biela under another name, and the tables that it names;
/// returns the path of the mechanism.
pub(in crate::cli) fn write_new(name: &str, from: &str, folder: &Path) -> Result<PathBuf, Error> {
    if !is_identifier(name) {
        let similar = similar_identifier(name);
        let example = similar.map(|name| format!("; expected for example `{name}`"));
        return Err(Error::Usage(format!(
            "`{name}` is no name of a mechanism: letters, digits and `_`, not starting with a \
             digit, no word of the C language, and no device of Windows such as `con`{}",
            example.unwrap_or_default()
        )));
    }
    let template = TEMPLATES.iter().find(|template| template.name == from);
    let template = template.ok_or_else(|| {
        let names: Vec<&str> = TEMPLATES.iter().map(|template| template.name).collect();
        Error::Usage(unknown_name("shipped mechanism", from, &names))
    })?;
    let text = renamed(template, name);
    let own = folder.join(format!("{name}.toml"));
    let mut files = vec![(own.clone(), text.as_str())];
    let tables = template.tables.iter();
    files.extend(tables.map(|(name, text)| (folder.join(name), *text)));
    if let Some((path, _)) = files.iter().find(|(path, _)| path.exists()) {
        return Err(exists(path));
    }
    for (path, text) in &files {
        create(path, text)?;
    }
    Ok(own)
}

/// Returns the template's text under another name.
fn renamed(template: &Template, name: &str) -> String {
    let line = |name: &str| format!("\nname = \"{name}\"\n");
    template.text.replacen(&line(template.name), &line(name), 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use biela::mechanism::{Mechanism, Source};

    #[test]
    fn every_shipped_mechanism_is_a_template() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../mechanisms");
        let mut shipped: Vec<String> = std::fs::read_dir(&folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| {
                path.extension()
                    .is_some_and(|extension| extension == "toml")
            })
            .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
            .collect();
        shipped.sort();
        assert!(TEMPLATES.iter().map(|template| template.name).eq(shipped));
    }

    #[test]
    fn templates_are_mechanisms_of_the_new_name() {
        for template in TEMPLATES {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("new.toml");
            std::fs::write(&path, renamed(template, "new_one")).unwrap();
            for (name, text) in template.tables {
                std::fs::write(folder.path().join(name), text).unwrap();
            }
            let source = Source::open("new.toml", &path).unwrap();
            let (mechanism, warnings) = Mechanism::parse(&source).unwrap();
            assert_eq!(mechanism.name, "new_one");
            assert!(warnings.is_empty(), "{}", template.name);
            assert_eq!(mechanism.table_files.len(), template.tables.len());
        }
    }
}
