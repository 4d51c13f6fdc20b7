//! The mechanism inside an FMU.

use std::io::{self, Seek, Write};
use std::path::Path;
use std::sync::Arc;

use super::decisions::{Decisions, RESOURCE};
use super::variables::Quantity;
use crate::fmi::error::Failure;
use crate::fmi::model_description::{Document, ModelDescription};
use crate::fmi::package::{self, RuntimeLibrary};
use crate::mechanism::{Mechanism, Severity, Source};

/// Reads the mechanism from the folder of resources, and the decisions of its export.
pub(super) fn read(resources: &Path) -> Result<(Arc<Mechanism>, Decisions), Failure> {
    let mechanism = Arc::new(read_mechanism(resources)?);
    let decisions = Decisions::read(resources, &mechanism)?;
    Ok((mechanism, decisions))
}

/// Reads the mechanism from the folder of resources.
fn read_mechanism(resources: &Path) -> Result<Mechanism, Failure> {
    let path = resources.join(RESOURCE);
    let source = Source::open(RESOURCE, &path).map_err(|error| {
        let path = path.display();
        Failure::Failed(format!("cannot read the mechanism `{path}`: {error}"))
    })?;
    match Mechanism::parse(&source) {
        Ok((mechanism, _)) => Ok(mechanism),
        Err(diagnostics) => {
            let errors = diagnostics.iter().filter(|d| d.severity == Severity::Error);
            let errors: Vec<_> = errors.map(|d| d.one_line(&source)).collect();
            Err(Failure::Failed(errors.join("; ")))
        }
    }
}

/// Writes the FMU of a mechanism: its file, its model description, runtime libraries and documents.
/// The same input gives the same bytes.
///
/// # Errors
///
/// `out` cannot be written.
pub fn write_fmu(
    out: impl Write + Seek,
    source: &Source,
    mechanism: &Arc<Mechanism>,
    description: &ModelDescription<'_, Quantity>,
    libraries: &[RuntimeLibrary],
    documents: &[Document],
    generated: Option<&str>,
) -> io::Result<()> {
    let decisions = Decisions::of(mechanism).files(mechanism);
    let mut resources = vec![(RESOURCE, source.text().as_bytes())];
    for (name, text) in &decisions {
        resources.push((name, text.as_bytes()));
    }
    for file in &mechanism.table_files {
        resources.push((file.name.as_str(), file.text.as_bytes()));
    }
    package::write(
        out,
        description,
        libraries,
        &resources,
        documents,
        generated,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmi::mechanism_model::MechanismModel;
    use crate::fmi::mechanism_model::decisions::OMITTED_REACTIONS;
    use crate::fmi::mechanism_model::description::{describe, describe_decided};
    use crate::fmi::mechanism_model::guid::guid_decided;
    use crate::fmi::model::Model as _;
    use crate::fmi::state::{Interface, Version};
    use crate::kinematics::{Origin, Solver, omitted_reactions};
    use std::fs;

    /// A bar on three cranks: the reactions of its three pins are indeterminate.
    const THREE_CRANKS: &str = r#"
format = 1
name = "three_cranks"
[ground.markers]
A = [0, 0]
B = [1, 0]
C = [2, 0]
[bodies]
one = { markers = { O = [0, 0], P = [1, 0] }, estimate = [0, 0, "60*deg"] }
two = { markers = { O = [0, 0], P = [1, 0] }, estimate = [1, 0, "60*deg"] }
three = { markers = { O = [0, 0], P = [1, 0] }, estimate = [2, 0, "60*deg"] }
bar = { markers = { A = [0, 0], B = [1, 0], C = [2, 0] }, mass = 1, estimate = [0.5, 0.8, 0] }
[joints]
A = { type = "revolute", markers = ["ground.A", "one.O"] }
B = { type = "revolute", markers = ["ground.B", "two.O"] }
C = { type = "revolute", markers = ["ground.C", "three.O"] }
P = { type = "revolute", markers = ["one.P", "bar.A"] }
Q = { type = "revolute", markers = ["two.P", "bar.B"] }
R = { type = "revolute", markers = ["three.P", "bar.C"] }
[drivers]
angle = { coordinate = "angle", markers = ["ground.A", "one.O"], start = "60*deg" }
"#;

    /// Returns the content of each file in `resources/` of an FMU.
    fn resources(fmu: Vec<u8>) -> Vec<(String, String)> {
        let mut archive = zip::ZipArchive::new(io::Cursor::new(fmu)).unwrap();
        let files = (0..archive.len()).filter_map(|index| {
            let file = archive.by_index(index).unwrap();
            let path = String::from_utf8(file.name_raw().to_vec()).unwrap();
            let name = path.strip_prefix("resources/")?.to_owned();
            Some((name, io::read_to_string(file).unwrap()))
        });
        files.collect()
    }

    /// Returns the mechanism and the resources of its FMU.
    fn exported() -> (Arc<Mechanism>, Vec<(String, String)>) {
        let source = Source::new(RESOURCE, THREE_CRANKS);
        let mechanism = Arc::new(Mechanism::parse(&source).unwrap().0);
        let solver = Solver::new(Arc::clone(&mechanism)).unwrap();
        let mut fmu = io::Cursor::new(Vec::new());
        write_fmu(
            &mut fmu,
            &source,
            &mechanism,
            &describe(&mechanism, solver.structure(), Version::Fmi2),
            &[],
            &[],
            None,
        )
        .unwrap();
        let files = resources(fmu.into_inner());
        (mechanism, files)
    }

    fn load(files: &[(String, String)]) -> Result<MechanismModel, Failure> {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in files {
            fs::write(folder.path().join(name), content).unwrap();
        }
        MechanismModel::load(folder.path(), Interface::CoSimulation)
    }

    /// Each list stands for the decision of another processor at export: the variables are those of the
    /// export's model description, in the same order, and the GUID tells one list from the other.
    #[test]
    fn an_fmu_keeps_to_the_reactions_that_its_export_has_omitted() {
        let (mechanism, files) = exported();
        let listed = |name: &str| files.iter().position(|(file, _)| file == name);
        let place = listed(OMITTED_REACTIONS).expect("the export lists them");
        assert_eq!(files.len(), 2);
        let solver = Solver::new(Arc::clone(&mechanism)).unwrap();
        let all: Vec<_> = (0..mechanism.joints.len()).map(Origin::Joint).collect();
        let here = omitted_reactions(&mechanism);
        assert!(!here.is_empty(), "indeterminate reactions are omitted");
        let mut guids = Vec::new();
        for omitted in [&here[..], &[], &all[..1], &all[1..3], &all[..5]] {
            let decisions = Decisions {
                omitted: omitted.to_vec(),
                has_local_states: false,
            };
            let description =
                describe_decided(&mechanism, solver.structure(), Version::Fmi2, &decisions);
            let mut files = files.clone();
            let names = omitted.iter().map(|origin| origin.name(&mechanism));
            let list: String = names.map(|name| format!("{name}\n")).collect();
            if omitted == here {
                assert_eq!(files[place].1, list);
            }
            files[place].1 = list;
            let model = load(&files).unwrap();
            assert_eq!(model.guid(), description.guid);
            let names = |variables: &[crate::fmi::Variable<_>]| -> Vec<String> {
                variables
                    .iter()
                    .map(|variable| variable.name.clone())
                    .collect()
            };
            assert_eq!(names(model.variables()), names(&description.variables));
            guids.push(description.guid);
        }
        let count = guids.len();
        guids.sort();
        guids.dedup();
        assert_eq!(guids.len(), count);

        // A list that is lost stands for none, which the GUID tells.
        let mut without = files.clone();
        without.remove(place);
        let guid = load(&without).unwrap().guid().to_owned();
        assert_eq!(guid, guid_decided(&mechanism, &Decisions::default()));
        assert_ne!(guid, super::super::guid(&mechanism));
    }

    #[test]
    fn a_list_of_other_names_is_refused() {
        let (_, mut files) = exported();
        files
            .iter_mut()
            .find(|(name, _)| name == OMITTED_REACTIONS)
            .unwrap()
            .1 = "A\nZ\n".into();
        let error = load(&files).map(drop).unwrap_err().to_string();
        assert_eq!(
            error,
            "`omitted_reactions.txt` names `Z`, which is no joint or constraint of \
             `mechanism.toml`: the resources do not belong together"
        );
    }
}
