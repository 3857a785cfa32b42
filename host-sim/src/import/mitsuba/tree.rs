//! The XML as a tree of elements that know their line: parameters substituted, includes in place, names checked.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::super::{ImportError, Options, suggest};

/// How deep includes may nest: a file that includes itself ends here (Mitsuba's limit).
const INCLUDE_DEPTH: u32 = 15;

/// Elements with a `type`, then properties, then what stands inside a transform.
const OBJECTS: [&str; 9] = [
    "scene",
    "integrator",
    "sensor",
    "film",
    "rfilter",
    "sampler",
    "shape",
    "bsdf",
    "texture",
];
const TAGS: [&str; 25] = [
    "scene",
    "integrator",
    "sensor",
    "film",
    "rfilter",
    "sampler",
    "shape",
    "bsdf",
    "texture",
    "emitter",
    "ref",
    "default",
    "include",
    "float",
    "integer",
    "boolean",
    "string",
    "point",
    "vector",
    "rgb",
    "spectrum",
    "transform",
    "translate",
    "rotate",
    "scale",
];
const MORE_TAGS: [&str; 2] = ["lookat", "matrix"];

/// One element of the scene file.
#[derive(Debug)]
pub(super) struct Element {
    pub tag: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element>,
    pub line: u32,
    /// The file it stands in.
    pub file: Rc<Path>,
}

impl Element {
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes
            .iter()
            .find(|(n, _)| n == name)
            .map(|(_, value)| value.as_str())
    }

    /// The plugin's name; empty for what has none.
    pub fn kind(&self) -> &str {
        self.attribute("type").unwrap_or("")
    }

    /// `<bsdf type="plastic">`, `<float name="radius">`, `<scene>`.
    pub fn describe(&self) -> String {
        match ["type", "name", "id"]
            .iter()
            .find_map(|name| Some((name, self.attribute(name)?)))
        {
            Some((name, value)) => format!("<{} {name}=\"{value}\">", self.tag),
            None => format!("<{}>", self.tag),
        }
    }

    /// Its `id`, or a name that says where it stands.
    pub fn name(&self) -> String {
        match self.attribute("id") {
            Some(id) => id.to_string(),
            None => format!("{} at line {}", self.kind(), self.line),
        }
    }

    pub fn error(&self, message: impl Into<String>) -> ImportError {
        ImportError::at(&self.file, self.line, message)
    }

    /// A file this element names: relative to the file the element stands in.
    pub fn resolve(&self, name: &str) -> PathBuf {
        self.file.parent().unwrap_or(Path::new("")).join(name)
    }
}

/// Reads a scene file and all it includes; the root is a `<scene>`.
pub(super) fn read(
    path: &Path,
    options: &Options,
    warnings: &mut Vec<String>,
) -> Result<Element, ImportError> {
    let given = options
        .parameters
        .iter()
        .map(|(name, value)| (name.clone(), value.clone()));
    let mut reader = TreeReader {
        lenient: options.lenient,
        parameters: given.collect(),
        used: BTreeSet::new(),
        warnings,
        depth: 0,
    };
    let root = reader.file(path)?;
    if root.tag != "scene" {
        return Err(root.error(format!(
            "the root is {}; wrap it in <scene version=\"3.0.0\">",
            root.describe()
        )));
    }
    if let Some(name) = options
        .parameters
        .keys()
        .find(|name| !reader.used.contains(*name))
    {
        let known: Vec<&str> = reader.used.iter().map(String::as_str).collect();
        let advice = suggest::advice(name, &known);
        return Err(ImportError::new(
            path,
            format!("no ${name} in the scene to set; {advice}"),
        ));
    }
    Ok(root)
}

struct TreeReader<'o> {
    lenient: bool,
    /// Given ones first, then `<default>`s as they are met.
    parameters: Vec<(String, String)>,
    used: BTreeSet<String>,
    warnings: &'o mut Vec<String>,
    depth: u32,
}

/// The file being read: its name and where its lines begin.
struct Source {
    path: Rc<Path>,
    line_starts: Vec<usize>,
}

impl Source {
    fn line(&self, byte: usize) -> u32 {
        self.line_starts.partition_point(|&start| start <= byte) as u32
    }

    fn error(&self, node: roxmltree::Node, message: String) -> ImportError {
        ImportError::at(&self.path, self.line(node.range().start), message)
    }
}

impl TreeReader<'_> {
    fn file(&mut self, path: &Path) -> Result<Element, ImportError> {
        let text = std::fs::read_to_string(path).map_err(|error| ImportError::io(path, &error))?;
        let document = roxmltree::Document::parse(&text).map_err(|error| {
            // roxmltree ends its message with "at row:column".
            let said = error.to_string();
            let what = said.rsplit_once(" at ").map_or(said.as_str(), |(what, _)| what);
            ImportError::at(
                path,
                error.pos().row,
                format!("not well-formed XML: {what}; correct it"),
            )
        })?;
        let line_starts = std::iter::once(0)
            .chain(text.match_indices('\n').map(|(at, _)| at + 1))
            .collect();
        let source = Source {
            path: Rc::from(path),
            line_starts,
        };
        let root = document.root_element();
        self.version(&source, root)?;
        let mut elements = self.element(&source, root, true)?;
        elements
            .pop()
            .ok_or_else(|| source.error(root, format!("<{}> is no scene", root.tag_name().name())))
    }

    fn version(&mut self, source: &Source, root: roxmltree::Node) -> Result<(), ImportError> {
        let tag = root.tag_name().name();
        let Some(version) = root.attribute("version") else {
            return Err(source.error(root, format!("<{tag}> has no version; add version=\"3.0.0\"")));
        };
        let parts: Vec<Option<u32>> = version.split('.').map(|part| part.parse().ok()).collect();
        match parts[..] {
            [Some(2 | 3), Some(_), Some(_)] => Ok(()),
            [Some(_), Some(_), Some(_)] => self.refuse(
                source,
                root,
                format!("version {version} is not supported; convert it to Mitsuba 3.0.0"),
            ),
            _ => Err(source.error(
                root,
                format!("version \"{version}\" is not three numbers; write \"3.0.0\""),
            )),
        }
    }

    /// An error, or a warning where those are asked for.
    fn refuse(&mut self, source: &Source, node: roxmltree::Node, message: String) -> Result<(), ImportError> {
        self.report(source.error(node, message))
    }

    fn report(&mut self, error: ImportError) -> Result<(), ImportError> {
        if !self.lenient {
            return Err(error);
        }
        self.warnings.push(error.to_string());
        Ok(())
    }

    /// The element itself; nothing for a `<default>`, several for an `<include>`.
    fn element(
        &mut self,
        source: &Source,
        node: roxmltree::Node,
        root: bool,
    ) -> Result<Vec<Element>, ImportError> {
        let tag = node.tag_name().name();
        if !TAGS.contains(&tag) && !MORE_TAGS.contains(&tag) {
            let known = [&TAGS[..], &MORE_TAGS[..]].concat();
            self.refuse(
                source,
                node,
                format!("<{tag}> is not supported; {}", suggest::advice(tag, &known)),
            )?;
            return Ok(Vec::new());
        }
        let mut element = Element {
            tag: tag.to_string(),
            attributes: Vec::new(),
            children: Vec::new(),
            line: source.line(node.range().start),
            file: source.path.clone(),
        };
        for attribute in node.attributes() {
            let value = self.substitute(source, node, attribute.value())?;
            element.attributes.push((attribute.name().to_string(), value));
        }
        self.check_attributes(source, node, &element, root)?;
        match tag {
            "default" => self.default(source, node, &element)?,
            "include" => return self.include(&element),
            _ => {}
        }
        for child in node.children() {
            if let Some(text) = child
                .text()
                .filter(|text| child.is_text() && !text.trim().is_empty())
            {
                self.refuse_text(source, child, text, &element)?;
            } else if child.is_element() {
                element.children.extend(self.element(source, child, false)?);
            }
        }
        Ok(if tag == "default" {
            Vec::new()
        } else {
            vec![element]
        })
    }

    /// Words between tags; the line is that of the first of them.
    fn refuse_text(
        &mut self,
        source: &Source,
        node: roxmltree::Node,
        text: &str,
        holder: &Element,
    ) -> Result<(), ImportError> {
        let start = node.range().start + (text.len() - text.trim_start().len());
        let words: String = text.trim().chars().take(20).collect();
        let message = format!("text \"{words}\" in {}; remove it", holder.describe());
        self.report(ImportError::at(&source.path, source.line(start), message))
    }

    fn check_attributes(
        &mut self,
        source: &Source,
        node: roxmltree::Node,
        element: &Element,
        root: bool,
    ) -> Result<(), ImportError> {
        let tag = element.tag.as_str();
        let (required, optional): (&[&str], &[&str]) = match tag {
            "scene" => (&[], &["version", "type", "id"]),
            _ if root => (&["type"], &["version", "id", "name"]),
            "emitter" => (&["type"], &["id", "name"]),
            _ if OBJECTS.contains(&tag) => (&["type"], &["id", "name"]),
            "ref" => (&["id"], &["name"]),
            "include" => (&["filename"], &["name"]),
            "transform" => (&["name"], &[]),
            "point" | "vector" => (&["name"], &["value", "x", "y", "z"]),
            "translate" | "scale" => (&[], &["value", "x", "y", "z"]),
            "rotate" => (&["angle"], &["value", "x", "y", "z"]),
            "lookat" => (&["origin", "target"], &["up"]),
            "matrix" => (&["value"], &[]),
            _ => (&["name", "value"], &[]),
        };
        for (name, _) in &element.attributes {
            if !required.contains(&name.as_str()) && !optional.contains(&name.as_str()) {
                let advice = suggest::advice(name, &[required, optional].concat());
                self.refuse(
                    source,
                    node,
                    format!("<{tag}> has no attribute \"{name}\"; {advice}"),
                )?;
            }
        }
        match required.iter().find(|name| element.attribute(name).is_none()) {
            Some(name) => Err(source.error(
                node,
                format!("{} lacks {name}=\"...\"; add it", element.describe()),
            )),
            None => Ok(()),
        }
    }

    fn default(
        &mut self,
        source: &Source,
        node: roxmltree::Node,
        element: &Element,
    ) -> Result<(), ImportError> {
        let name = element.attribute("name").unwrap_or_default();
        if name.is_empty() {
            return Err(source.error(node, "<default> has an empty name; give it one".to_string()));
        }
        self.used.insert(name.to_string());
        if !self.parameters.iter().any(|(known, _)| known == name) {
            self.parameters.push((
                name.to_string(),
                element.attribute("value").unwrap_or_default().to_string(),
            ));
        }
        Ok(())
    }

    fn include(&mut self, element: &Element) -> Result<Vec<Element>, ImportError> {
        let path = element.resolve(element.attribute("filename").unwrap_or_default());
        if !path.is_file() {
            return Err(element.error(format!("no file {} to include; check the name", path.display())));
        }
        if self.depth == INCLUDE_DEPTH {
            return Err(element.error(format!(
                "{INCLUDE_DEPTH} includes deep; does the file include itself?"
            )));
        }
        self.depth += 1;
        let root = self.file(&path);
        self.depth -= 1;
        let root = root?;
        Ok(if root.tag == "scene" {
            root.children
        } else {
            vec![root]
        })
    }

    /// Puts parameters in the place of `$name`; the longest matching name wins, `\$` is a dollar sign.
    fn substitute(
        &mut self,
        source: &Source,
        node: roxmltree::Node,
        value: &str,
    ) -> Result<String, ImportError> {
        let mut out = String::new();
        let mut rest = value;
        while let Some(at) = rest.find('$') {
            let (before, after) = (&rest[..at], &rest[at + 1..]);
            if let Some(before) = before.strip_suffix('\\') {
                out.push_str(before);
                out.push('$');
                rest = after;
                continue;
            }
            let matching = self
                .parameters
                .iter()
                .filter(|(name, _)| after.starts_with(name.as_str()));
            let Some((name, text)) = matching.max_by_key(|(name, _)| name.len()) else {
                let wanted: String = after
                    .chars()
                    .take_while(|c| c.is_alphanumeric() || *c == '_')
                    .collect();
                let known: Vec<&str> = self.parameters.iter().map(|(name, _)| name.as_str()).collect();
                let advice = match known.is_empty() {
                    true => format!("add <default name=\"{wanted}\" value=\"...\"/> before it"),
                    false => suggest::advice(&wanted, &known),
                };
                return Err(source.error(node, format!("${wanted} is not defined; {advice}")));
            };
            out.push_str(before);
            out.push_str(text);
            self.used.insert(name.clone());
            rest = &after[name.len()..];
        }
        out.push_str(rest);
        Ok(out)
    }
}
