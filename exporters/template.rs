//! Fills in the templates of `templates/`.

use minijinja::syntax::SyntaxConfig;
use minijinja::value::ValueKind;
use minijinja::{AutoEscape, Environment, Error, UndefinedBehavior, Value};

use crate::frame;

/// The file `path` of a package, filled in from `template`. Markup is escaped except in Markdown.
///
/// The filter `micro` writes a number as [`frame::micro`] does, and numbers with spaces between them. Templates and values are
/// both ours: tests make sure that they match.
pub(crate) fn fill(path: &str, template: &str, values: &Value) -> String {
    let mut environment = Environment::new();
    let mut syntax = SyntaxConfig::builder();
    syntax.trim_blocks(true).lstrip_blocks(true).keep_trailing_newline(true);
    environment.set_syntax(syntax.build().expect("the delimiters are the usual ones"));
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.add_filter("micro", micro);
    environment.set_auto_escape_callback(|path| match path.ends_with(".md") {
        true => AutoEscape::None,
        false => AutoEscape::Html,
    });
    environment.render_named_str(path, template, values).expect("our templates parse and name these values only")
}

fn micro(value: Value) -> Result<String, Error> {
    match value.kind() {
        ValueKind::Seq => Ok(value.try_iter()?.map(micro).collect::<Result<Vec<_>, _>>()?.join(" ")),
        _ => Ok(frame::micro(value.try_into()?)),
    }
}
