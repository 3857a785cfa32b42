//! The bytes of a glTF file, and what of them may be read.

use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::{STANDARD, STANDARD_NO_PAD};
use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::{Source, View};
use gltf::{Accessor, Document};

use super::super::error::ImportError;

/// More items than any mesh here can have.
const MOST: usize = 1 << 26;

/// All buffers, each as long as the file says.
pub(super) struct Buffers {
    data: Vec<Vec<u8>>,
    /// Where files that are named lie.
    folder: PathBuf,
}

impl Buffers {
    pub fn read(path: &Path, document: &Document, blob: Option<Vec<u8>>) -> Result<Self, ImportError> {
        let mut buffers = Buffers {
            data: Vec::new(),
            folder: path.parent().unwrap_or(Path::new("")).to_path_buf(),
        };
        let mut blob = blob;
        for buffer in document.buffers() {
            let wrong = |what: String| ImportError::new(path, format!("buffers[{}]: {what}", buffer.index()));
            let data = match buffer.source() {
                Source::Bin => blob.take().ok_or_else(|| {
                    wrong("has neither a uri nor a binary part in this file; export again".into())
                })?,
                Source::Uri(uri) => buffers.uri(uri).map_err(wrong)?,
            };
            if data.len() < buffer.length() {
                return Err(wrong(format!(
                    "has {} of its {} bytes; export the model again",
                    data.len(),
                    buffer.length()
                )));
            }
            buffers.data.push(data);
        }
        Ok(buffers)
    }

    /// What a `data:` URI holds, or the file it names.
    pub fn uri(&self, uri: &str) -> Result<Vec<u8>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (_, encoded) = data
                .split_once(";base64,")
                .ok_or("its data: uri is not base64; export the model again")?;
            return STANDARD
                .decode(encoded)
                .or_else(|_| STANDARD_NO_PAD.decode(encoded))
                .map_err(|error| format!("its data: uri is broken ({error}); export the model again"));
        }
        if uri.contains("://") {
            return Err(format!(
                "{uri} is not on this computer; put the file beside the model"
            ));
        }
        let name = urlencoding::decode(uri).map_err(|_| format!("{uri} is no file name; correct it"))?;
        let file = self.folder.join(name.as_ref());
        std::fs::read(&file).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => {
                format!("no file {}; put it beside the model", file.display())
            }
            _ => format!("{} cannot be read ({error})", file.display()),
        })
    }

    pub fn get(&self, buffer: &gltf::Buffer) -> Option<&[u8]> {
        self.data.get(buffer.index()).map(Vec::as_slice)
    }

    /// The bytes of a view, where it lies within its buffer.
    pub fn view(&self, view: &View) -> Result<&[u8], String> {
        let end = view.offset().checked_add(view.length());
        let bytes = end.and_then(|end| self.get(&view.buffer())?.get(view.offset()..end));
        bytes.ok_or_else(|| {
            let (view, buffer) = (view.index(), view.buffer().index());
            format!("bufferViews[{view}] reaches beyond buffers[{buffer}]; export the model again")
        })
    }

    /// That an accessor's items are of one of these kinds, and all there.
    pub fn check(
        &self,
        accessor: &Accessor,
        dimensions: Dimensions,
        types: &[DataType],
    ) -> Result<(), String> {
        let name = format!("accessors[{}]", accessor.index());
        if accessor.dimensions() != dimensions || !types.contains(&accessor.data_type()) {
            let (is, of) = (accessor.dimensions(), accessor.data_type());
            return Err(format!(
                "{name} holds {is:?} of {of:?}, which is not allowed here; export the model again"
            ));
        }
        let count = accessor.count();
        if count == 0 || count > MOST {
            return Err(format!("{name} has {count} items; 1 to {MOST} are possible"));
        }
        if accessor.view().is_none() && accessor.sparse().is_none() {
            return Err(format!("{name} has no data; export the model again"));
        }
        if let Some(view) = accessor.view() {
            self.span(&name, &view, accessor.offset(), count, accessor.size())?;
        }
        if let Some(sparse) = accessor.sparse() {
            let (indices, values, some) = (sparse.indices(), sparse.values(), sparse.count());
            if some == 0 || some > count {
                return Err(format!(
                    "{name} replaces {some} of its {count} items; export the model again"
                ));
            }
            let size = indices.index_type().size();
            self.span(&name, &indices.view(), indices.offset(), some, size)?;
            self.span(&name, &values.view(), values.offset(), some, accessor.size())?;
        }
        Ok(())
    }

    fn span(&self, name: &str, view: &View, offset: usize, count: usize, size: usize) -> Result<(), String> {
        let room = self.view(view)?.len();
        let stride = view.stride().unwrap_or(size);
        let end = (count - 1)
            .checked_mul(stride)
            .and_then(|last| last.checked_add(size)?.checked_add(offset));
        if stride < size || end.is_none_or(|end| end > room) {
            let view = view.index();
            return Err(format!(
                "{name} reaches beyond bufferViews[{view}]; export the model again"
            ));
        }
        Ok(())
    }
}
