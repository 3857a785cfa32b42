//! The parameters of one element: each is asked for by name and type, and what nobody asked for is an error.

use std::cell::RefCell;
use std::collections::HashMap;

use super::super::math::Affine;
use super::super::{ImportError, suggest};
use super::color::{self, Quantity};
use super::transform;
use super::tree::Element;
use crate::desc::Vec3;

/// What all parts of a scene are read with.
pub(super) struct Context<'a> {
    pub lenient: bool,
    pub warnings: RefCell<Vec<String>>,
    /// Every element with an `id`.
    pub ids: HashMap<&'a str, &'a Element>,
}

impl<'a> Context<'a> {
    pub fn new(root: &'a Element, lenient: bool, warnings: Vec<String>) -> Result<Self, ImportError> {
        let mut ids = HashMap::new();
        collect_ids(root, &mut ids)?;
        Ok(Self {
            lenient,
            warnings: RefCell::new(warnings),
            ids,
        })
    }

    /// What is not supported: an error, or a warning where those are asked for.
    pub fn refuse(&self, element: &Element, message: impl Into<String>) -> Result<(), ImportError> {
        let error = element.error(message);
        if !self.lenient {
            return Err(error);
        }
        self.warn(&error);
        Ok(())
    }

    /// What is read, but not quite as the file may mean it.
    pub fn warn(&self, what: &ImportError) {
        self.warnings.borrow_mut().push(what.to_string());
    }

    /// A plugin that is none of `known`.
    pub fn refuse_kind(&self, element: &Element, known: &[&str]) -> Result<(), ImportError> {
        let near = suggest::advice(element.kind(), known);
        let advice = if near.starts_with("did") {
            near
        } else {
            format!("use {}", suggest::list(known))
        };
        self.refuse(
            element,
            format!("{} is not supported; {advice}", element.describe()),
        )
    }

    /// The element a `<ref>` points at.
    pub fn resolve(&self, reference: &Element) -> Result<&'a Element, ImportError> {
        let id = reference.attribute("id").unwrap_or_default();
        self.ids.get(id).copied().ok_or_else(|| {
            let known: Vec<&str> = self.ids.keys().copied().collect();
            let near = suggest::advice(id, &known);
            let advice = if near.starts_with("did") {
                near
            } else {
                format!("give something id=\"{id}\"")
            };
            reference.error(format!("nothing has the id \"{id}\"; {advice}"))
        })
    }
}

fn collect_ids<'a>(element: &'a Element, ids: &mut HashMap<&'a str, &'a Element>) -> Result<(), ImportError> {
    if let Some(id) = element.attribute("id").filter(|_| element.tag != "ref")
        && let Some(first) = ids.insert(id, element)
    {
        return Err(element.error(format!("id \"{id}\" is taken by line {}; rename one", first.line)));
    }
    element
        .children
        .iter()
        .try_for_each(|child| collect_ids(child, ids))
}

/// An element's children as named parameters and nested objects.
pub(super) struct Params<'c, 'a> {
    pub element: &'a Element,
    context: &'c Context<'a>,
    /// The names asked for so far.
    known: RefCell<Vec<&'static str>>,
    /// The kinds of nested objects asked for so far.
    nested: RefCell<Vec<&'static str>>,
}

impl<'c, 'a> Params<'c, 'a> {
    pub fn new(context: &'c Context<'a>, element: &'a Element) -> Self {
        Self {
            element,
            context,
            known: RefCell::default(),
            nested: RefCell::default(),
        }
    }

    /// A float above zero.
    pub fn positive(&self, name: &'static str) -> Result<Option<f64>, ImportError> {
        self.checked(name, "above 0", |x| x > 0.0)
    }

    /// A float for which `holds`; `range` says it in words.
    pub fn checked(
        &self,
        name: &'static str,
        range: &str,
        holds: impl Fn(f64) -> bool,
    ) -> Result<Option<f64>, ImportError> {
        self.property(name, &["float", "integer"], |element| {
            let number = number(element, value(element))?;
            match holds(number) {
                true => Ok(number),
                false => Err(element.error(format!("{name} {number} is out of range; it must be {range}"))),
            }
        })
    }

    /// A whole number within `range`.
    pub fn integer(
        &self,
        name: &'static str,
        range: std::ops::RangeInclusive<i64>,
    ) -> Result<Option<i64>, ImportError> {
        self.property(name, &["integer"], |element| {
            let text = value(element);
            let number: i64 = text
                .trim()
                .parse()
                .map_err(|_| element.error(format!("\"{text}\" is not a whole number; correct it")))?;
            match range.contains(&number) {
                true => Ok(number),
                false => {
                    let (low, high) = (range.start(), range.end());
                    Err(element.error(format!(
                        "{name} {number} is out of range; it must be {low} to {high}"
                    )))
                }
            }
        })
    }

    pub fn boolean(&self, name: &'static str) -> Result<Option<bool>, ImportError> {
        self.property(name, &["boolean"], |element| {
            match value(element).to_ascii_lowercase().as_str() {
                "true" => Ok(true),
                "false" => Ok(false),
                other => Err(element.error(format!(
                    "\"{other}\" is neither true nor false; write one of them"
                ))),
            }
        })
    }

    pub fn string(&self, name: &'static str) -> Result<Option<(&'a Element, &'a str)>, ImportError> {
        self.property(name, &["string"], |element| Ok((element, value(element))))
    }

    pub fn color(&self, name: &'static str, quantity: Quantity) -> Result<Option<Vec3>, ImportError> {
        self.property(name, &["rgb", "spectrum", "float"], |element| {
            color::read(element, name, quantity)
        })
    }

    pub fn triple(&self, name: &'static str) -> Result<Option<Vec3>, ImportError> {
        self.property(name, &["point", "vector"], |element| {
            let given = transform::triple(element)?;
            match given {
                [Some(x), Some(y), Some(z)] => Ok([x, y, z]),
                _ => Err(element.error(format!("{} needs x, y and z; add them", element.describe()))),
            }
        })
    }

    pub fn transform(&self, name: &'static str) -> Result<Option<Affine>, ImportError> {
        self.property(name, &["transform"], |element| {
            transform::read(element, self.context)
        })
    }

    /// A number or a name, whichever is given.
    pub fn number_or_string(&self, name: &'static str) -> Result<Option<&'a Element>, ImportError> {
        self.property(name, &["float", "integer", "string"], Ok)
    }

    /// The `<texture>` of this name, or a reference to one.
    pub fn texture(&self, name: &'static str) -> Result<Option<&'a Element>, ImportError> {
        self.nested.borrow_mut().push("texture");
        let named = |child: &&Element| child.attribute("name") == Some(name);
        for child in self.element.children.iter().filter(named) {
            let target = if child.tag == "ref" {
                self.context.resolve(child)?
            } else {
                child
            };
            if target.tag == "texture" {
                return Ok(Some(target));
            }
        }
        Ok(None)
    }

    /// Nested objects with this tag, and references to such, in the file's order.
    pub fn objects(&self, tag: &'static str) -> Result<Vec<&'a Element>, ImportError> {
        self.nested.borrow_mut().push(tag);
        let mut found = Vec::new();
        for child in &self.element.children {
            let target = if child.tag == "ref" {
                self.context.resolve(child)?
            } else {
                child
            };
            if target.tag == tag {
                found.push(target);
            }
        }
        Ok(found)
    }

    /// The one nested object with this tag, if any; a second one is an error.
    pub fn object(&self, tag: &'static str) -> Result<Option<&'a Element>, ImportError> {
        let found = self.objects(tag)?;
        match found[..] {
            [] => Ok(None),
            [only] => Ok(Some(only)),
            [_, second, ..] => {
                let holder = self.element.describe();
                Err(second.error(format!("a second <{tag}> in {holder}; keep one")))
            }
        }
    }

    pub fn refuse(&self, element: &Element, message: String) -> Result<(), ImportError> {
        self.context.refuse(element, message)
    }

    /// Refuses every child that nothing asked for.
    pub fn finish(self) -> Result<(), ImportError> {
        let (known, nested) = (self.known.into_inner(), self.nested.into_inner());
        let holder = self.element.describe();
        for child in &self.element.children {
            match child.attribute("name").filter(|_| is_property(&child.tag)) {
                Some(name) if known.contains(&name) => {}
                Some(name) => {
                    let advice = suggest::advice(name, &known);
                    self.context
                        .refuse(child, format!("{holder} has no parameter \"{name}\"; {advice}"))?;
                }
                None => {
                    let target = if child.tag == "ref" {
                        self.context.resolve(child)?
                    } else {
                        child
                    };
                    if !nested.contains(&target.tag.as_str()) {
                        let what = target.describe();
                        self.context
                            .refuse(child, format!("{what} cannot stand in {holder}; move it out"))?;
                    }
                }
            }
        }
        Ok(())
    }

    /// The child of this name, read by `read` if its tag is one of `tags`; a second one is an error.
    fn property<T>(
        &self,
        name: &'static str,
        tags: &[&str],
        read: impl FnOnce(&'a Element) -> Result<T, ImportError>,
    ) -> Result<Option<T>, ImportError> {
        self.known.borrow_mut().push(name);
        let mut named = self
            .element
            .children
            .iter()
            .filter(|c| c.attribute("name") == Some(name));
        let Some(child) = named.next() else {
            return Ok(None);
        };
        if let Some(second) = named.next() {
            return Err(second.error(format!("{name} is already set by line {}; keep one", child.line)));
        }
        if !tags.contains(&child.tag.as_str()) {
            let wanted = suggest::list(tags);
            let given = child.tag.as_str();
            self.context.refuse(
                child,
                format!("{name} is given as <{given}>; write it as <{wanted}>"),
            )?;
            return Ok(None);
        }
        read(child).map(Some)
    }
}

fn is_property(tag: &str) -> bool {
    matches!(
        tag,
        "float" | "integer" | "boolean" | "string" | "point" | "vector" | "rgb" | "spectrum" | "transform"
    )
}

pub(super) fn value(element: &Element) -> &str {
    element.attribute("value").unwrap_or_default()
}

/// A finite number.
pub(super) fn number(element: &Element, text: &str) -> Result<f64, ImportError> {
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(element.error(format!("\"{text}\" is not a finite number; correct it"))),
        Err(_) => Err(element.error(format!("\"{text}\" is not a number; correct it"))),
    }
}

/// Numbers parted by commas or blanks.
pub(super) fn numbers(element: &Element, text: &str) -> Result<Vec<f64>, ImportError> {
    let words = text.split([',', ' ']).filter(|word| !word.is_empty());
    words.map(|word| number(element, word)).collect()
}
