//! Tests of reading robot files from paths.

use crate::diag::Diagnostics;
use crate::import::tests::{Folder, default_file_options, name_at_call_site};
use crate::import::{FileOptions, read_imported_file};
use std::fs;

/// Returns the text of a file in a folder, or the errors without the name of the folder.
fn read_file_or_errors(folder: &Folder, file: &str) -> String {
    let mut cx = Diagnostics::new();
    let options = FileOptions { path: name_at_call_site(file), ..default_file_options() };
    let text = read_imported_file(&folder.0.join(file), &options, &mut cx);
    assert_eq!(text.is_some(), cx.is_empty());
    text.unwrap_or_else(|| {
        cx.full_message_texts().join("\n").replace(&format!("{}/", folder.0.display()), "…")
    })
}

#[test]
fn robot_file_is_read_from_its_path() {
    let folder = Folder::new("read", &[("urdf/r.urdf", "<robot/>")]);
    assert_eq!(read_file_or_errors(&folder, "urdf/r.urdf"), "<robot/>");
}

#[test]
fn missing_file_error_lists_similar_files() {
    let folder = Folder::new("missing", &[("urdf/readme.txt", "")]);
    let found = read_file_or_errors(&folder, "urdf/pandas.urdf");
    assert_eq!(found, "there is no file `urdf/pandas.urdf`\n\n= help: looked for `…urdf/pandas.urdf`");
    folder.write_file("urdf/panda.urdf", b"");
    let found = read_file_or_errors(&folder, "urdf/pandas.urdf");
    assert_eq!(found, "there is no file `urdf/pandas.urdf`\n\n= help: did you mean `urdf/panda.urdf`?");
    let found = read_file_or_errors(&folder, "robots/panda.urdf");
    assert_eq!(
        found,
        "there is no file `robots/panda.urdf`\n\n= help: there is no directory `…robots` either"
    );
}

#[test]
fn binary_files_are_rejected() {
    let folder = Folder::new("refused", &[("urdf/r.urdf", "")]);
    assert_eq!(read_file_or_errors(&folder, "urdf"), "`urdf` is a directory, expected a URDF file");
    folder.write_file("r.urdf", b"<robot>\n\xff</robot>");
    assert_eq!(
        read_file_or_errors(&folder, "r.urdf"),
        "`r.urdf` is not UTF-8 text: line 2\n\n= help: save the file in UTF-8"
    );
    let file = fs::File::create(folder.0.join("large.urdf")).expect("a temporary file");
    file.set_len(40 << 20).expect("a sparse file");
    assert_eq!(
        read_file_or_errors(&folder, "large.urdf"),
        "`large.urdf` has 40 MiB, expected at most 16 MiB"
    );
    #[cfg(unix)]
    {
        let found = read_file_or_errors(&folder, "r.urdf/x.urdf");
        assert!(found.starts_with("there is no file `r.urdf/x.urdf`"), "{found}");
        let options = FileOptions { path: name_at_call_site("null"), ..default_file_options() };
        let mut cx = Diagnostics::new();
        assert!(read_imported_file("/dev/null".as_ref(), &options, &mut cx).is_none());
        assert_eq!(cx.full_message_texts(), ["`null` is not a regular file"]);
    }
}
