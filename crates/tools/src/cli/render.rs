//! Diagnostics as text: the line of the file, with the error underlined, and help.

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

use biela::mechanism::{Diagnostic, Severity, Source, Span};

/// Renders the diagnostics, each with its lines of the file, separated by blank lines; `styled`
/// adds colours for a terminal.
#[must_use]
pub fn render(source: &Source, diagnostics: &[Diagnostic], styled: bool) -> String {
    let renderer = if styled {
        Renderer::styled()
    } else {
        Renderer::plain()
    };
    let rendered: Vec<String> = diagnostics
        .iter()
        .map(|diagnostic| renderer.render(&[group(source, diagnostic)]))
        .collect();
    rendered.join("\n\n")
}

fn group<'a>(source: &'a Source, diagnostic: &'a Diagnostic) -> Group<'a> {
    let level = match diagnostic.severity {
        Severity::Warning => Level::WARNING,
        Severity::Error => Level::ERROR,
    };
    let title = level
        .primary_title(diagnostic.message.as_str())
        .id(diagnostic.code);
    let mut group = if diagnostic.labels.is_empty() {
        Group::with_title(title)
    } else {
        title.element(snippet(source, diagnostic))
    };
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    group
}

fn snippet<'a>(
    source: &'a Source,
    diagnostic: &'a Diagnostic,
) -> Snippet<'a, annotate_snippets::Annotation<'a>> {
    let kinds =
        std::iter::once(AnnotationKind::Primary).chain(std::iter::repeat(AnnotationKind::Context));
    let annotations = diagnostic.labels.iter().zip(kinds).map(|(label, kind)| {
        let annotation = kind.span(within(source, &label.span));
        if label.text.is_empty() {
            annotation
        } else {
            annotation.label(label.text.as_str())
        }
    });
    Snippet::source(source.text())
        .path(source.name())
        .annotations(annotations)
}

/// Returns a span moved to boundaries of characters, which a span from elsewhere may miss.
fn within(source: &Source, span: &Span) -> Span {
    let start = source.text().floor_char_boundary(span.start);
    start..source.text().floor_char_boundary(span.end).max(start)
}
