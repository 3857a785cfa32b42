//! From the word SCENE to a scene.

use std::collections::BTreeMap;
use std::path::Path;

use super::args::SceneArgs;
use super::{Failure, complain};
use crate::builtin;
use crate::desc::SceneDesc;
use crate::import;
use crate::quantise;
use crate::run::MAX_SIDE;

/// Endings of the files that are scenes.
const ENDINGS: [&str; 6] = ["xml", "gltf", "glb", "obj", "ply", "mlx"];

/// Loads the scene; what is to be said about it goes to the standard error, a line each: what is lost always, what was
/// made of it unless `quiet`.
pub fn load(args: &SceneArgs, quiet: bool) -> Result<SceneDesc, Failure> {
    let scene = if is_file(&args.scene) {
        from_file(args, quiet)?
    } else {
        built_in(args)?
    };
    for (side, name) in [(scene.width, "wide"), (scene.height, "high")] {
        if side == 0 || side > MAX_SIDE {
            let message = format!(
                "{}: the picture is {side} pixels {name}; 1 to {MAX_SIDE} are possible",
                args.scene
            );
            return Err(Failure::Wrong(message));
        }
    }
    Ok(scene)
}

/// A word with an ending or a folder is a file; so is what lies there as one, unless a built-in scene has the name.
fn is_file(word: &str) -> bool {
    let path = Path::new(word);
    let named_like_one = path.extension().is_some() || path.components().count() > 1;
    named_like_one || (builtin::scene(word).is_none() && path.exists())
}

fn from_file(args: &SceneArgs, quiet: bool) -> Result<SceneDesc, Failure> {
    let parameters = args.definitions.iter().cloned().collect::<BTreeMap<_, _>>();
    let options = import::Options {
        lenient: args.lenient,
        parameters,
    };
    let loaded =
        import::load(Path::new(&args.scene), &options).map_err(|error| Failure::Wrong(error.to_string()))?;
    for note in loaded.notes.iter().filter(|_| !quiet) {
        complain("note", note);
    }
    for warning in loaded.warnings.iter().chain(&quantise::losses(&loaded.scene)) {
        complain("warning", warning);
    }
    Ok(loaded.scene)
}

fn built_in(args: &SceneArgs) -> Result<SceneDesc, Failure> {
    if let Some((name, _)) = args.definitions.first() {
        let message = format!(
            "{}: a built-in scene has no parameter {name}; leave out -D",
            args.scene
        );
        return Err(Failure::Wrong(message));
    }
    builtin::scene(&args.scene).ok_or_else(|| {
        let names: Vec<&str> = builtin::all().iter().map(|&(name, _)| name).collect();
        Failure::Wrong(unknown(&args.scene, &names, |file| Path::new(file).exists()))
    })
}

/// The line for a name that is no scene's: a file that it may mean, else the nearest name, else where to look.
fn unknown(word: &str, names: &[&str], exists: impl Fn(&str) -> bool) -> String {
    let file = ENDINGS
        .iter()
        .map(|ending| format!("{word}.{ending}"))
        .find(|file| exists(file));
    let near = names
        .iter()
        .map(|name| (strsim::osa_distance(&word.to_lowercase(), name), name));
    let near = near
        .filter(|&(edits, name)| edits <= 1 + name.len() / 4)
        .min_by_key(|&(edits, _)| edits);
    let advice = match (file, near) {
        (Some(file), _) => format!("did you mean the file {file}?"),
        (None, Some((_, name))) => format!("did you mean {name}?"),
        (None, None) => "host-sim scenes lists them, and a file is named with its ending".to_string(),
    };
    format!("{word}: no such built-in scene; {advice}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_suggested() {
        let names = ["cornell", "spheres", "seed"];
        let told = |word| unknown(word, &names, |_| false);
        assert_eq!(
            told("sphres"),
            "sphres: no such built-in scene; did you mean spheres?"
        );
        assert_eq!(
            told("Cornel"),
            "Cornel: no such built-in scene; did you mean cornell?"
        );
        assert!(told("teapot").contains("host-sim scenes lists them"));
        let told = unknown("teapot", &names, |file| file == "teapot.obj");
        assert_eq!(
            told,
            "teapot: no such built-in scene; did you mean the file teapot.obj?"
        );
    }

    #[test]
    fn endings_and_folders_make_a_file() {
        assert!(is_file("a.xml") && is_file("folder/a") && is_file("./a"));
        assert!(!is_file("no-such-name"));
    }
}
