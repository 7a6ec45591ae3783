//! How the crates are built inside: few names at each root, no room of plotter-vector that uses a later one,
//! and no tool of the examples that uses another's room.

use crate::papers::assert_in;
use std::path::{Path, PathBuf};

/// Names at a crate's root, its rooms among them: as many as a page shows at once.
const MOST_NAMES: usize = 45;

/// plotter-vector's rooms in the order in which a picture goes through them.
const ROOMS: [&str; 12] = [
    "picture",
    "ink",
    "raster",
    "stroke",
    "areas",
    "centreline",
    "order",
    "write",
    "svg_in",
    "report",
    "trace",
    "follow",
];

/// The rooms of the examples that several tools use, each of them the first alone.
const SHARED_ROOMS: [&str; 3] = ["shared", "drawings", "machine"];

fn sources(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name).join("src")
}

/// What a crate's root holds: its public rooms, and the names of its `pub use`.
fn root_of(name: &str) -> (usize, usize) {
    let text = std::fs::read_to_string(sources(name).join("lib.rs")).unwrap();
    let rooms = text.lines().filter(|line| line.starts_with("pub mod ")).count();
    let names = text.split("pub use ").skip(1).map(|rest| {
        let path = rest.split(';').next().unwrap();
        path.split_once('{').map_or(1, |(_, list)| {
            list.trim_end_matches('}').split(',').filter(|name| !name.trim().is_empty()).count()
        })
    });
    (rooms, names.sum())
}

#[test]
fn each_root_has_few_names() {
    for name in ["plotter-motion", "plotter-hal", "plotter-vector", "plotter-stitch", "plotter-replay"] {
        let (rooms, names) = root_of(name);
        assert!(rooms + names <= MOST_NAMES, "{name}: {rooms} rooms and {names} names");
        assert_in("docs/architecture.md", name, &[(rooms + names).to_string()]);
    }
}

/// The files of a folder and of those in it.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    files.into_iter().chain(folders.iter().flat_map(|folder| self::files(folder))).collect()
}

/// The sources of a room, without the files of its tests.
fn texts(room: &Path) -> Vec<(PathBuf, String)> {
    let sources = files(room).into_iter().filter(|file| {
        file.extension().is_some_and(|ending| ending == "rs")
            && !file.file_stem().unwrap().to_str().unwrap().ends_with("tests")
    });
    sources.map(|file| (file.clone(), std::fs::read_to_string(file).unwrap())).collect()
}

/// Those of `rooms` that a text names, without its comments and its tests.
fn rooms_named(text: &str, rooms: &[&str]) -> Vec<usize> {
    let code = text.split("#[cfg(test)]\nmod ").next().unwrap();
    let code: String = code.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    let mut found = Vec::new();
    for rest in code.split("crate::").skip(1) {
        // A list names a room where a brace or a comma at its own depth comes before.
        let list = if rest.starts_with('{') { rest.split(';').next().unwrap() } else { rest };
        let mut depth = 0;
        let mut starts = Vec::new();
        if list.starts_with('{') {
            for (at, sign) in list.char_indices() {
                depth += i32::from(sign == '{') - i32::from(sign == '}');
                if depth == 0 {
                    break;
                }
                if depth == 1 && matches!(sign, '{' | ',') {
                    starts.push(&list[at + 1..]);
                }
            }
        } else {
            starts.push(list);
        }
        for start in starts {
            let name: String = start
                .trim_start()
                .chars()
                .take_while(|sign| sign.is_alphanumeric() || *sign == '_')
                .collect();
            found.extend(rooms.iter().position(|room| *room == name));
        }
    }
    found
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn rooms_use_the_rooms_before_them_alone() {
    assert_eq!(
        rooms_named("use crate::{areas::X, order::{a, write}};\nfn f() { crate::ink::x(); }", &ROOMS),
        [4, 6, 1]
    );
    let folder = sources("plotter-vector");
    for (index, room) in ROOMS.iter().enumerate() {
        for (file, text) in texts(&folder.join(room)) {
            for other in rooms_named(&text, &ROOMS) {
                assert!(other <= index, "{}: {room} uses {}", file.display(), ROOMS[other]);
            }
        }
    }
}

#[test]
fn a_tool_uses_its_own_room_and_those_for_all() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let lib = std::fs::read_to_string(folder.join("lib.rs")).unwrap();
    let rooms: Vec<&str> =
        lib.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';')).collect();
    for shared in SHARED_ROOMS {
        assert!(rooms.contains(&shared), "{shared} is no room");
    }
    let files_at_the_root = std::fs::read_dir(&folder).unwrap().filter(|entry| {
        let path = entry.as_ref().unwrap().path();
        path.is_file()
    });
    assert_eq!(files_at_the_root.count(), 1, "every file but lib.rs is in a room");
    let mut arrows = 0;
    for room in &rooms {
        let may_use: &[&str] = if SHARED_ROOMS.contains(room) { &SHARED_ROOMS[..1] } else { &SHARED_ROOMS };
        for (file, text) in texts(&folder.join(room)) {
            for other in rooms_named(&text, &rooms) {
                let used = &rooms[other];
                assert!(used == room || may_use.contains(used), "{}: {room} uses {used}", file.display());
                arrows += usize::from(used != room);
            }
        }
    }
    assert!(arrows > 10, "only {arrows} uses were found");
}
