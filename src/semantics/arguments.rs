//! Arguments and the parameters that they are bound to.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::program::repeated;
use super::scope::{Context, Env, Local, Scope};
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::tree::{Arg, Block, Name, Param};

/// Arguments by name: value, the name as written, and the value's place.
pub(super) type Arguments<'t> = BTreeMap<&'t str, (Value, &'t Name, Span)>;

impl<'t> Context<'t> {
    /// Arguments by name; unnamed and repeated ones are reported.
    pub fn arguments(&self, env: &Rc<Env<'t>>, owner: &Name, block: &'t Block<Arg>) -> Arguments<'t> {
        let mut args: Arguments<'t> = BTreeMap::new();
        for node in &block.nodes {
            let arg = &node.value;
            let value = self.evaluate(Scope { env, geometry: None }, &arg.value);
            let Some(name) = &arg.name else {
                let message = format!("arguments of `{}` need names", owner.text);
                self.report(
                    Diagnostic::new(Code::E0307, message, arg.value.span, "an argument without a name")
                        .expected("`name: value`", "a value alone"),
                );
                continue;
            };
            match args.get(name.text.as_str()) {
                Some((_, first, _)) => self.report(repeated("argument", name, first.span)),
                None => {
                    args.insert(&name.text, (value, name, arg.value.span));
                }
            }
        }
        args
    }

    /// The environment that binds parameters to arguments or defaults; unknown arguments are reported.
    pub fn bind(
        &self,
        module: usize,
        params: &'t Block<Param>,
        mut args: Arguments<'t>,
        owner: &Name,
    ) -> BTreeMap<&'t str, Local<'t>> {
        let global = Env::global(module);
        let mut locals: BTreeMap<&'t str, Local<'t>> = BTreeMap::new();
        let mut first: BTreeMap<&'t str, &'t Name> = BTreeMap::new();
        for node in &params.nodes {
            let param = &node.value;
            if let Some(earlier) = first.insert(&param.name.text, &param.name) {
                self.report(repeated("parameter", &param.name, earlier.span));
                continue;
            }
            let default = self.evaluate(Scope { env: &global, geometry: None }, &param.default);
            let value = match (args.remove(param.name.text.as_str()), &default) {
                (None, _) => default,
                (Some((value, ..)), Value::Poison) => value,
                (Some((Value::Quantity(given), _, span)), Value::Quantity(wanted)) => {
                    match given.dimension == wanted.dimension {
                        true => Value::Quantity(given),
                        false => {
                            let what = format!("`{}`", param.name.text);
                            let diagnostic = self.wrong_dimension(&given, span, wanted.dimension, &what);
                            self.report(diagnostic.related(param.default.span, "its default"));
                            Value::Poison
                        }
                    }
                }
                (Some((value, _, span)), wanted) => {
                    let same = std::mem::discriminant(&value) == std::mem::discriminant(wanted);
                    if !same && value != Value::Poison {
                        let message = format!("`{}` must be {}", param.name.text, wanted.described());
                        self.report(
                            Diagnostic::new(Code::E0304, message, span, value.described())
                                .expected(wanted.described(), value.described())
                                .related(param.default.span, "its default"),
                        );
                    }
                    if same { value } else { Value::Poison }
                }
            };
            locals.insert(&param.name.text, Local::Param(value));
        }
        for (_, name, _) in args.values() {
            let known: Vec<&str> = locals.keys().copied().collect();
            let message = format!("`{}` has no parameter `{}`", owner.text, name.text);
            let diagnostic = Diagnostic::new(Code::E0210, message, name.span, "not a parameter");
            let listed = match known.is_empty() {
                true => "no arguments".to_string(),
                false => known.iter().map(|k| format!("`{k}`")).collect::<Vec<_>>().join(", "),
            };
            let diagnostic =
                diagnostic.expected(listed, format!("`{}`", name.text)).related(owner.span, "declared here");
            self.report(self.with_nearest(diagnostic, name, known));
        }
        locals
    }
}
