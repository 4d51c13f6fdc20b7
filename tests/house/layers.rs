//! Imports point one way: between the layers of the library, and from file to file.
//!
//! A file uses another one if it names something that the other defines, in a `use` or in a path.
//! A module and its own children may use each other; any larger circle fails, and so does one
//! between children of one module. Code for tests does not count.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use petgraph::algo::kosaraju_scc;
use petgraph::graph::DiGraph;
use petgraph::visit::{Bfs, EdgeRef, Reversed};
use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};

/// The folders of the two libraries: that of FMUs, and that of the program on it.
const SOURCES: [&str; 2] = ["src", "crates/tools/src"];

/// The layers of both, and those that each may use.
const LAYERS: [(&str, &[&str]); 11] = [
    ("unit", &[]),
    ("mechanism", &["unit"]),
    ("kinematics", &["unit", "mechanism"]),
    ("dynamics", &["unit", "mechanism", "kinematics"]),
    ("fmi", &["unit", "mechanism", "kinematics", "dynamics"]),
    ("write", &["mechanism"]),
    ("drawing", &["unit", "mechanism", "kinematics"]),
    (
        "page",
        &[
            "unit",
            "mechanism",
            "kinematics",
            "dynamics",
            "write",
            "drawing",
        ],
    ),
    (
        "studio",
        &[
            "unit",
            "mechanism",
            "kinematics",
            "write",
            "drawing",
            "page",
        ],
    ),
    (
        "exchange",
        &["unit", "mechanism", "kinematics", "fmi", "write", "drawing"],
    ),
    (
        "cli",
        &[
            "unit",
            "mechanism",
            "kinematics",
            "dynamics",
            "fmi",
            "write",
            "drawing",
            "page",
            "exchange",
        ],
    ),
];

/// The modules of the libraries, the root of `biela` first.
struct Library {
    modules: Vec<Module>,
}

struct Module {
    file: PathBuf,
    /// The root of its library.
    root: usize,
    parent: Option<usize>,
    children: BTreeMap<String, usize>,
    /// Paths by the name under which the module imports them.
    imports: BTreeMap<String, Vec<String>>,
    /// Modules all of whose items it imports.
    globs: Vec<Vec<String>>,
    /// Every path with more than one part.
    paths: BTreeSet<Vec<String>>,
}

/// The meaning of a path.
#[derive(Clone, Copy)]
enum Target {
    Module(usize),
    /// An item that this module defines.
    ItemOf(usize),
}

impl Library {
    fn read() -> Self {
        let mut library = Self {
            modules: Vec::new(),
        };
        for folder in SOURCES {
            library.add_file(project().join(folder).join("lib.rs"), None);
        }
        library
    }

    fn add(&mut self, file: PathBuf, parent: Option<usize>) -> usize {
        let root = parent.map_or(self.modules.len(), |parent| self.modules[parent].root);
        self.modules.push(Module {
            file,
            root,
            parent,
            children: BTreeMap::new(),
            imports: BTreeMap::new(),
            globs: Vec::new(),
            paths: BTreeSet::new(),
        });
        self.modules.len() - 1
    }

    fn add_file(&mut self, file: PathBuf, parent: Option<usize>) -> usize {
        let text = std::fs::read_to_string(&file)
            .unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let syntax =
            syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let module = self.add(file, parent);
        self.add_items(module, &syntax.items);
        module
    }

    fn add_items(&mut self, module: usize, items: &[syn::Item]) {
        for item in items {
            match item {
                syn::Item::Mod(child) if !is_for_tests(&child.attrs) => {
                    let name = child.ident.to_string();
                    let index = if let Some((_, items)) = &child.content {
                        let index = self.add(self.modules[module].file.clone(), Some(module));
                        self.add_items(index, items);
                        index
                    } else {
                        let file = file_of_child(&self.modules[module].file, &name);
                        self.add_file(file, Some(module))
                    };
                    self.modules[module].children.insert(name, index);
                }
                syn::Item::Mod(_) => {}
                item => Names(&mut self.modules[module]).visit_item(item),
            }
        }
    }

    /// Returns the module or item that a path of `module` means; `None` if it is none of the
    /// libraries, or defined by `module` itself.
    fn resolve(&self, module: usize, path: &[String]) -> Option<Target> {
        let [first, rest @ ..] = path else {
            return None;
        };
        let first = match first.as_str() {
            "crate" => Target::Module(self.modules[module].root),
            "biela" => Target::Module(0),
            "self" => Target::Module(module),
            "super" => Target::Module(self.modules[module].parent?),
            name => self.member(module, name)?,
        };
        rest.iter().try_fold(first, |target, name| match target {
            // A variant, or a function of a type.
            Target::ItemOf(_) => Some(target),
            Target::Module(module) if name == "super" => {
                Some(Target::Module(self.modules[module].parent?))
            }
            Target::Module(module) => {
                Some(self.member(module, name).unwrap_or(Target::ItemOf(module)))
            }
        })
    }

    /// Returns what a name means in a module that has not defined it.
    fn member(&self, module: usize, name: &str) -> Option<Target> {
        if let Some(&child) = self.modules[module].children.get(name) {
            return Some(Target::Module(child));
        }
        let import = self.modules[module].imports.get(name)?;
        // A name that means itself comes from another crate.
        if import.first().is_some_and(|first| first == name) {
            return None;
        }
        self.resolve(module, import)
    }

    /// Returns a path as the file writes it, by the file that uses it and the one that defines it.
    fn uses(&self) -> BTreeMap<(&Path, &Path), String> {
        let mut uses = BTreeMap::new();
        for (index, module) in self.modules.iter().enumerate() {
            let imports = module.imports.values().chain(&module.paths);
            let items = imports.filter_map(|path| match self.resolve(index, path)? {
                Target::ItemOf(owner) => Some((owner, path)),
                Target::Module(_) => None,
            });
            let globs = module.globs.iter().filter_map(|path| {
                let (Target::Module(owner) | Target::ItemOf(owner)) = self.resolve(index, path)?;
                Some((owner, path))
            });
            for (owner, path) in items.chain(globs) {
                let owner = &self.modules[owner].file;
                if *owner != module.file {
                    uses.entry((module.file.as_path(), owner.as_path()))
                        .or_insert_with(|| path.join("::"));
                }
            }
        }
        uses
    }
}

/// The file of the module `name` that `file` declares.
fn file_of_child(file: &Path, name: &str) -> PathBuf {
    let folder = folder_of(file);
    let single = folder.join(name).with_extension("rs");
    if single.exists() {
        single
    } else {
        folder.join(name).join("mod.rs")
    }
}

/// The folder that holds the children of a file.
fn folder_of(file: &Path) -> PathBuf {
    let stem = file.file_stem().expect("it is a file");
    let folder = file.parent().expect("it is in a folder");
    if stem == "mod" || stem == "lib" {
        folder.to_owned()
    } else {
        folder.join(stem)
    }
}

fn is_for_tests(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute
                .parse_args::<syn::Path>()
                .is_ok_and(|condition| condition.is_ident("test"))
    })
}

/// Collects the names that the items of a module use.
struct Names<'a>(&'a mut Module);

impl Names<'_> {
    fn import(&mut self, before: &[String], tree: &syn::UseTree) {
        let with = |name: &syn::Ident| [before, &[name.to_string()]].concat();
        match tree {
            syn::UseTree::Path(path) => self.import(&with(&path.ident), &path.tree),
            syn::UseTree::Name(name) if name.ident == "self" => {
                let own = before.last().expect("something comes before `self`");
                self.0.imports.insert(own.clone(), before.to_vec());
            }
            syn::UseTree::Name(name) => {
                let path = with(&name.ident);
                self.0.imports.insert(name.ident.to_string(), path);
            }
            syn::UseTree::Rename(rename) => {
                // Several may be imported as `_`.
                let path = with(&rename.ident);
                let name = format!("{} as {}", rename.ident, rename.rename);
                self.0.imports.insert(name, path.clone());
                self.0.imports.insert(rename.rename.to_string(), path);
            }
            syn::UseTree::Glob(_) => self.0.globs.push(before.to_vec()),
            syn::UseTree::Group(group) => {
                for tree in &group.items {
                    self.import(before, tree);
                }
            }
        }
    }

    /// Notes the paths in what a macro is given, where they are tokens only.
    fn note_tokens(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Ident(name) if colons == 2 || path.is_empty() => {
                    path.push(name.to_string());
                    colons = 0;
                    continue;
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' && !path.is_empty() => {
                    colons += 1;
                    continue;
                }
                TokenTree::Ident(name) => {
                    self.note(std::mem::replace(&mut path, vec![name.to_string()]));
                    colons = 0;
                    continue;
                }
                TokenTree::Group(group) => self.note_tokens(group.stream()),
                TokenTree::Punct(_) | TokenTree::Literal(_) => {}
            }
            self.note(std::mem::take(&mut path));
            colons = 0;
        }
        self.note(path);
    }

    fn note(&mut self, path: Vec<String>) {
        if path.len() > 1 {
            self.0.paths.insert(path);
        }
    }
}

impl<'a> Visit<'a> for Names<'_> {
    fn visit_item(&mut self, item: &'a syn::Item) {
        let attributes = match item {
            syn::Item::Fn(item) => &item.attrs,
            syn::Item::Impl(item) => &item.attrs,
            syn::Item::Use(item) => &item.attrs,
            _ => &Vec::new(),
        };
        if !is_for_tests(attributes) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'a syn::ItemUse) {
        self.import(&[], &item.tree);
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        let segments = path.segments.iter();
        self.note(segments.map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'a syn::Macro) {
        self.visit_path(&call.path);
        self.note_tokens(call.tokens.clone());
    }
}

fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn name_of(file: &Path) -> String {
    let mut folders = SOURCES.iter().map(|folder| project().join(folder));
    let name = folders.find_map(|folder| file.strip_prefix(folder).ok());
    let name = name.expect("it is a source");
    name.display().to_string().replace('\\', "/")
}

/// Files as nodes; an edge leads from a file to one that it uses, with the path that it writes.
type Uses = DiGraph<PathBuf, String>;

fn graph(library: &Library) -> Uses {
    let mut graph = Uses::new();
    let files: BTreeSet<_> = library.modules.iter().map(|m| m.file.clone()).collect();
    let nodes: BTreeMap<_, _> = files
        .into_iter()
        .map(|file| (file.clone(), graph.add_node(file)))
        .collect();
    for ((from, to), path) in library.uses() {
        graph.add_edge(nodes[from], nodes[to], path);
    }
    graph
}

/// Returns whether `child` is a file of a module that the file `parent` declares.
fn is_child(child: &Path, parent: &Path) -> bool {
    let folder = folder_of(parent);
    let own = child.parent() == Some(&folder) && child.file_stem().is_some_and(|s| s != "mod");
    let own_folder = child.file_stem().is_some_and(|s| s == "mod")
        && child.parent().and_then(Path::parent) == Some(&folder);
    child != parent && (own || own_folder)
}

/// Returns the circles of a graph, each as a set of names.
fn circles(graph: &Uses) -> Vec<BTreeSet<String>> {
    let components = kosaraju_scc(graph).into_iter();
    let circles = components.filter(|component| component.len() > 1);
    let names = circles.map(|circle| circle.into_iter().map(|node| name_of(&graph[node])));
    names.map(Iterator::collect).collect()
}

/// Describes the uses within a set of files.
fn describe(graph: &Uses, files: &BTreeSet<String>) -> String {
    let mut text = String::new();
    for edge in graph.edge_references() {
        let [from, to] = [edge.source(), edge.target()].map(|node| name_of(&graph[node]));
        if files.contains(&from) && files.contains(&to) {
            let _ = writeln!(text, "  {from} uses {to}: {}", edge.weight());
        }
    }
    text
}

/// Returns the circles larger than a module and its own children.
fn forbidden_circles(graph: &Uses) -> Vec<BTreeSet<String>> {
    let mut found: Vec<BTreeSet<String>> = Vec::new();
    for component in kosaraju_scc(graph) {
        let files: Vec<_> = component.iter().map(|&node| &graph[node]).collect();
        let family = |parent: &&PathBuf| {
            let others = files.iter().filter(|file| *file != parent);
            others.into_iter().all(|file| is_child(file, parent))
        };
        if !files.iter().any(family) {
            found.push(files.into_iter().map(|file| name_of(file)).collect());
        }
    }
    // Between the children of one module.
    let mut downwards = graph.clone();
    downwards.retain_edges(|graph, edge| {
        let (from, to) = graph.edge_endpoints(edge).expect("it is an edge");
        !is_child(&graph[from], &graph[to])
    });
    let inner = circles(&downwards);
    let is_new = |circle: &BTreeSet<String>| !found.iter().any(|outer| outer.is_superset(circle));
    let new: Vec<_> = inner.into_iter().filter(is_new).collect();
    found.extend(new);
    found
}

#[test]
fn imports_form_no_circle() {
    let graph = graph(&Library::read());
    let mut message = String::new();
    for circle in forbidden_circles(&graph) {
        let _ = writeln!(message, "{circle:#?}:\n{}", describe(&graph, &circle));
    }
    assert!(message.is_empty(), "circles of imports:\n{message}");
}

#[test]
fn layers_use_those_below_them_only() {
    let graph = graph(&Library::read());
    let layer = |file: &Path| {
        let name = name_of(file);
        let layer = name.split(['/', '.']).next().expect("it has a name");
        layer.to_owned()
    };
    for edge in graph.edge_references() {
        let (from, to) = (&graph[edge.source()], &graph[edge.target()]);
        let [user, used] = [from, to].map(|file| layer(file));
        if user == used || user == "lib" {
            continue;
        }
        let (_, below) = LAYERS
            .iter()
            .find(|(name, _)| *name == user)
            .unwrap_or_else(|| panic!("{user} is no layer that this test knows"));
        assert!(
            below.contains(&used.as_str()),
            "{} uses {} of a layer that is not below it: {}",
            name_of(from),
            name_of(to),
            edge.weight()
        );
    }
}

/// A test that finds no files, or no uses, passes always.
#[test]
fn every_file_is_read_and_most_are_used() {
    let library = Library::read();
    let graph = graph(&library);
    assert!(graph.node_count() > 150, "{} files", graph.node_count());
    let root = graph
        .node_indices()
        .find(|&node| name_of(&graph[node]) == "mechanism/id.rs")
        .expect("the identifiers are at the bottom of all");
    let mut users = 0;
    let mut search = Bfs::new(Reversed(&graph), root);
    while search.next(Reversed(&graph)).is_some() {
        users += 1;
    }
    assert!(users > 120, "{users} files use the identifiers of bodies");
}
