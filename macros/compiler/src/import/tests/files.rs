//! Tests of reading robot files from paths.

use crate::diag::Diagnostics;
use crate::import::tests::{default_options, test_name};
use crate::import::{FileOptions, read_file};
use std::fs;
use std::path::PathBuf;

/// Temporary directory of one test, which is removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("linkwork-import-{test}-{}", std::process::id()));
        fs::create_dir_all(path.join("urdf")).expect("a temporary directory");
        Folder(path)
    }

    fn write_test_file(&self, file: &str, bytes: &[u8]) {
        fs::write(self.0.join(file), bytes).expect("a temporary file");
    }

    /// Returns the text of a file, or the errors without the name of the directory.
    fn import_test_file(&self, file: &str) -> String {
        let mut cx = Diagnostics::new();
        let options = FileOptions { path: test_name(file), ..default_options() };
        let text = read_file(&self.0.join(file), &options, &mut cx);
        assert_eq!(text.is_some(), cx.is_empty());
        text.unwrap_or_else(|| cx.messages().join("\n").replace(&format!("{}/", self.0.display()), "…"))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn robot_file_is_read_from_its_path() {
    let folder = Folder::new("read");
    folder.write_test_file("urdf/r.urdf", b"<robot/>");
    assert_eq!(folder.import_test_file("urdf/r.urdf"), "<robot/>");
}

#[test]
fn missing_file_error_lists_similar_files() {
    let folder = Folder::new("missing");
    let found = folder.import_test_file("urdf/pandas.urdf");
    assert_eq!(found, "there is no file `urdf/pandas.urdf`\n\n= help: looked for `…urdf/pandas.urdf`");
    folder.write_test_file("urdf/panda.urdf", b"");
    folder.write_test_file("urdf/readme.txt", b"");
    let found = folder.import_test_file("urdf/pandas.urdf");
    assert_eq!(found, "there is no file `urdf/pandas.urdf`\n\n= help: did you mean `urdf/panda.urdf`?");
    let found = folder.import_test_file("robots/panda.urdf");
    assert_eq!(
        found,
        "there is no file `robots/panda.urdf`\n\n= help: there is no directory `…robots` either"
    );
}

#[test]
fn binary_files_are_rejected() {
    let folder = Folder::new("refused");
    assert_eq!(folder.import_test_file("urdf"), "`urdf` is a directory, expected a URDF file");
    folder.write_test_file("r.urdf", b"<robot>\n\xff</robot>");
    assert_eq!(
        folder.import_test_file("r.urdf"),
        "`r.urdf` is not UTF-8 text: line 2\n\n= help: save the file in UTF-8"
    );
    let file = fs::File::create(folder.0.join("large.urdf")).expect("a temporary file");
    file.set_len(40 << 20).expect("a sparse file");
    assert_eq!(folder.import_test_file("large.urdf"), "`large.urdf` has 40 MiB, expected at most 16 MiB");
    #[cfg(unix)]
    {
        let found = folder.import_test_file("r.urdf/x.urdf");
        assert!(found.starts_with("there is no file `r.urdf/x.urdf`"), "{found}");
        let options = FileOptions { path: test_name("null"), ..default_options() };
        let mut cx = Diagnostics::new();
        assert!(read_file("/dev/null".as_ref(), &options, &mut cx).is_none());
        assert_eq!(cx.messages(), ["`null` is not a regular file"]);
    }
}
