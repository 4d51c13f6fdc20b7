//! Lines that are indented by tabs, or by blanks in place of them, as a tree.

use crate::exchange::error::{self, Error};

/// Deepest line: the file has about eight levels, results one more.
const DEEPEST: usize = 64;

/// The lines of a file, each with its depth.
pub(super) struct Tree<'a> {
    lines: Vec<Line<'a>>,
}

struct Line<'a> {
    text: &'a str,
    depth: usize,
    /// Its number in the file, from 1.
    number: usize,
    /// Index behind the last line below it.
    end: usize,
}

/// A line with those below it.
#[derive(Clone, Copy)]
pub(super) struct Node<'a> {
    tree: &'a Tree<'a>,
    index: usize,
}

/// Returns the number of blanks that stand for a tab: those of the least indented line with blanks
/// alone.
fn blanks_per_tab(text: &str) -> usize {
    let blanks = text.lines().filter_map(|line| {
        let rest = line.trim_start_matches(' ');
        let count = line.len() - rest.len();
        (count > 0 && !rest.is_empty() && !rest.starts_with('\t')).then_some(count)
    });
    blanks.min().unwrap_or(1)
}

impl<'a> Tree<'a> {
    pub(super) fn read(text: &'a str) -> Result<Self, Error> {
        let blanks = blanks_per_tab(text);
        let mut lines: Vec<Line> = Vec::new();
        let mut open: Vec<usize> = Vec::new();
        let all = text.lines().enumerate();
        // An empty value has tabs; lines without them part nothing.
        for (number, line) in all.filter(|(_, line)| !line.is_empty()) {
            let index = lines.len();
            let indent = line.len() - line.trim_start_matches(['\t', ' ']).len();
            let tabs = line[..indent].matches('\t').count();
            let depth = tabs + (indent - tabs) / blanks;
            if depth > DEEPEST {
                return Err(Error::TooDeep { line: number + 1 });
            }
            while open.last().is_some_and(|last| lines[*last].depth >= depth) {
                let last = open.pop().unwrap_or_default();
                lines[last].end = index;
            }
            open.push(index);
            let text = line.trim();
            lines.push(Line {
                text,
                depth,
                number: number + 1,
                end: index + 1,
            });
        }
        for last in open {
            lines[last].end = lines.len();
        }
        Ok(Self { lines })
    }

    /// Returns the line of the assembly.
    pub(super) fn assembly(&'a self) -> Result<Node<'a>, Error> {
        let is_first = |line: &Line| line.depth == 0 && line.text == "Assembly";
        let index = self.lines.iter().position(is_first);
        let index = index.ok_or_else(|| {
            let first = self.lines.get(1).map_or("", |line| line.text);
            Error::unexpected(2, first, "`Assembly`")
        })?;
        Ok(Node { tree: self, index })
    }
}

impl<'a> Node<'a> {
    pub(super) fn text(self) -> &'a str {
        self.tree.lines[self.index].text
    }

    /// Returns its line in the file, from 1.
    pub(super) fn line(self) -> usize {
        self.tree.lines[self.index].number
    }

    /// Returns the lines directly below it.
    pub(super) fn children(self) -> impl Iterator<Item = Node<'a>> {
        let Node { tree, index } = self;
        let end = tree.lines[index].end;
        let mut next = index + 1;
        std::iter::from_fn(move || {
            let index = next;
            next = tree.lines.get(index).filter(|_| index < end)?.end;
            Some(Node { tree, index })
        })
    }

    pub(super) fn child(self, key: &str) -> Option<Node<'a>> {
        self.children().find(|child| child.text() == key)
    }

    /// Returns a child that must be there; `place` says of what.
    pub(super) fn required(self, key: &'static str, place: &str) -> Result<Node<'a>, Error> {
        self.child(key).ok_or_else(|| Error::Missing {
            line: self.line(),
            place: place.to_owned(),
            key,
        })
    }

    /// Returns the text below a key.
    pub(super) fn value(self, key: &str) -> Option<&'a str> {
        Some(self.child(key)?.children().next()?.text())
    }

    /// Returns the text below a key that must be there.
    pub(super) fn required_value(self, key: &'static str, place: &str) -> Result<&'a str, Error> {
        let child = self.required(key, place)?;
        let value = child.children().next().map(Node::text);
        value.ok_or_else(|| Error::Missing {
            line: child.line(),
            place: place.to_owned(),
            key,
        })
    }

    /// Returns numbers in the lines below a key.
    pub(super) fn numbers<const N: usize>(
        self,
        key: &'static str,
        place: &str,
    ) -> Result<[f64; N], Error> {
        let child = self.required(key, place)?;
        let mut numbers = [0.0; N];
        let mut count = 0;
        for row in child.children() {
            for word in row.text().split_whitespace() {
                let Some(number) = numbers.get_mut(count) else {
                    return Err(Error::unexpected(row.line(), row.text(), "fewer numbers"));
                };
                *number = error::number(word, row.line())?;
                count += 1;
            }
        }
        if count < N {
            return Err(Error::Missing {
                line: child.line(),
                place: place.to_owned(),
                key,
            });
        }
        Ok(numbers)
    }
}
