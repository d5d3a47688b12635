//! Contacts of MJCF files: the shapes that collide, their friction, and the limit on contact points.

use super::mjcf::mjcf_options;
use super::*;
use std::fmt::Write as _;

/// Returns the contacts of a file with their coefficients of friction, and the contents that are left out, or
/// the errors.
fn import_contacts(contacts: ContactOption, text: &str) -> Result<(Vec<String>, Vec<String>), String> {
    let options = FileOptions { contacts, collisions: true, ..mjcf_options() };
    let mut cx = Diagnostics::new();
    let Some(imported) = import_text(text, &options, &mut cx) else {
        return Err(cx.full_message_texts().join("\n"));
    };
    let contacts = imported.contacts.iter().map(|contact| {
        let mut line = contact.name.text.clone();
        for (_, coefficient) in &contact.arguments.0 {
            write!(line, " {}", render_expr(coefficient)).expect("text");
        }
        line
    });
    Ok((contacts.collect(), imported.left_out))
}

fn contacts_of_file(text: &str) -> Vec<String> {
    import_contacts(ContactOption::File, text).expect("a mechanism").0
}

/// World, fixed body `s` with a moving child `m`, and a free body `f` with two shapes, all of which overlap.
fn overlapping_bodies(option: &str, contact: &str) -> String {
    format!(
        "<mujoco>{option}<default><pair condim='4'/><default class='q'><pair friction='.5 \
         .5'/></default></default><worldbody>\
         <geom name='w' type='box' size='1 1 1'/>\
         <body name='s' pos='0 0 1'><geom name='s' size='.2' pos='0 0 .1'/>\
         <body name='m' pos='0 0 .1'><geom name='m' size='.2' friction='.7 .02 .003'/><joint/>\
         <body name='n'><geom name='n' size='.2'/><joint/></body></body></body>\
         <body name='f'><freejoint/><geom name='f' size='1'/>\
         <geom name='g' size='1' contype='0' conaffinity='0' condim='6'/></body>\
         </worldbody><contact>{contact}</contact></mujoco>"
    )
}

/// The contacts are those that MuJoCo 4.0.0 finds: bodies that overlap, with the friction of its contacts.
#[test]
fn shapes_collide_as_in_mujoco() {
    let usual = ["m_w_contact 1", "n_w_contact 1", "f_w_contact 1", "m_s_contact 1", "n_s_contact 1"];
    let of_free_body = ["f_s_contact 1", "m_f_contact 1", "n_f_contact 1"];
    let expect = |option: &str, contact: &str, omitted: &[&str], added: &[&str]| {
        let lines = usual.iter().chain(&of_free_body).filter(|line| !omitted.contains(line)).chain(added);
        let mut expected: Vec<String> = lines.map(|line| line.to_string()).collect();
        let mut found = contacts_of_file(&overlapping_bodies(option, contact));
        expected.sort();
        found.sort();
        assert_eq!(found, expected, "{contact}");
    };
    expect("", "", &[], &[]);
    expect("<option><flag filterparent='disable'/></option>", "", &[], &["m_n_contact 1"]);
    expect("", "<exclude body1='world' body2='f'/>", &["f_w_contact 1"], &[]);
    expect(
        "",
        "<exclude body1='f' body2='s'/><exclude body1='n' body2='f'/>",
        &["f_s_contact 1", "n_f_contact 1"],
        &[],
    );
    expect("", "<pair geom1='f' geom2='g'/>", &[], &[]);
    expect("", "<pair geom1='w' geom2='s'/>", &[], &[]);
    expect("", "<pair geom1='w' geom2='g'/>", &[], &["g_w_contact 1 0.005"]);
    expect("", "<pair name='p' class='q' geom1='g' geom2='m' condim='3'/>", &[], &["p 0.5"]);
    expect("", "<pair geom1='m' geom2='n' condim='1'/>", &[], &["m_n_contact"]);
    let pair = "<exclude body1='world' body2='f'/>\
                <pair geom1='w' geom2='f' condim='6' friction='.4 .4 .2 .1 .1'/>";
    expect("", pair, &["f_w_contact 1"], &["f_w_contact 0.4 0.2 0.1"]);
}

/// A pair that the file declares replaces the contact that the masks permit.
#[test]
fn declared_pairs_have_their_own_friction() {
    let found = contacts_of_file(
        "<mujoco><worldbody><geom name='floor' type='plane' friction='2'/>\
         <body name='a'><freejoint/><geom name='a' size='1' friction='3'/></body>\
         <body name='b'><freejoint/><geom size='1' condim='6' friction='.1 .2 .3'/></body>\
         <body name='c'><freejoint/><geom type='capsule' size='1 1' priority='1' \
         friction='.1'/></body></worldbody>\
         <contact><pair geom1='floor' geom2='a' friction='.3 .3'/></contact></mujoco>",
    );
    assert_eq!(
        found,
        [
            "a_contact 0.3",
            "b_geom0_contact 2 0.2 0.3",
            "c_geom0_contact 0.1",
            "a_b_contact 3 0.2 0.3",
            "a_c_contact 0.1",
            "b_c_contact 0.1"
        ]
    );
}

/// Contacts with the world alone are an option of their own.
#[test]
fn contacts_with_the_world_are_an_option() {
    let (found, left_out) =
        import_contacts(ContactOption::Ground, &overlapping_bodies("", "")).expect("a mechanism");
    assert_eq!(found.len(), 6, "{found:?}");
    assert!(found.iter().all(|line| line.contains("w_contact") || line.contains('s')), "{found:?}");
    assert!(left_out.contains(&"contacts of bodies with each other".to_string()), "{left_out:?}");
}

#[test]
fn wrong_contacts_of_files_are_rejected() {
    for (contact, at, message) in [
        ("<pair geom1='w' geom2='ff'/>", "ff", "unknown geom `ff`"),
        ("<pair geom1='w'/>", "<pair", "`<pair>` without `geom2`"),
        ("<exclude body1='w' body2='f'/>", "w'", "unknown body `w`"),
        ("<exclude body1='f'/>", "<exclude", "`<exclude>` without `body2`"),
        ("<pair geom1='w' geom2='f' condim='2'/>", "2'/", "`condim` is 2"),
        ("<pair geom1='w' geom2='f' friction='.5'/>", ".5", "friction that differs along the tangents"),
        ("<pair geom1='w' geom2='f' adhesion='1'/>", "1'/", "`adhesion` of a contact is not supported"),
        (
            "<pair geom1='w' geom2='f'/><pair geom1='f' geom2='w'/>",
            "<pair geom1='f'",
            "second `<pair>` of `f` and `w`",
        ),
        ("<pair geom1='w' geom2='f' colour='1'/>", "colour", "unknown attribute `colour` of `<pair>`"),
    ] {
        let text = overlapping_bodies("", contact);
        let column = text.find(contact).zip(contact.find(at)).map(|(start, at)| start + at + 1);
        let expected = format!("r.xml:1:{}: {message}", column.expect("it is in the text"));
        let errors = import_contacts(ContactOption::File, &text).expect_err(contact);
        assert!(errors.starts_with(&expected), "{errors}\n{expected}");
    }
}

/// Contacts of surfaces without a contact point are listed by name.
#[test]
fn unsupported_contacts_are_listed() {
    let (found, left_out) = import_contacts(
        ContactOption::File,
        "<mujoco><worldbody><geom name='hills' type='hfield' hfield='h'/><body name='a'><freejoint/>\
         <geom type='ellipsoid' size='1 2 1' margin='.1'/></body><body name='b'><freejoint/>\
         <geom name='b' type='box' size='1 1 1'/></body><body name='c'><freejoint/><geom \
         size='1'/></body></worldbody>\
         <contact><pair geom1='hills' geom2='b'/></contact></mujoco>",
    )
    .expect("a mechanism");
    assert_eq!(found, ["b_c_contact 1"]);
    for line in [
        "contacts of surfaces that are not supported: a with b, a with c",
        "declared contacts of height fields, distance fields and shapes fitted to meshes: hills with b",
        "margins of contacts: 1",
    ] {
        assert!(left_out.iter().any(|found| found == line), "{left_out:?}");
    }
}

/// Boxes in a row: neighbours touch, and the most distant pairs do not fit into the contact points.
#[test]
fn nearest_bodies_share_the_contact_points() {
    let boxes: String = (1..=5)
        .map(|k| {
            format!(
                "<body name='d{k}' pos='{k} 0 0'><freejoint/><geom type='box' size='.1 .1 .1' \
                 mass='1'/></body>"
            )
        })
        .collect();
    let text = format!("<mujoco><worldbody><geom type='plane'/>{boxes}</worldbody></mujoco>");
    let found = hulls::read_description("dominoes", "mjcf = \"r.xml\", contacts = file", "struct S;", &text);
    let found = found.expect("a mechanism");
    let names: Vec<&str> = found.contacts.iter().map(|contact| contact.name.text.as_str()).collect();
    // Five contacts with the plane have 8 points each, six others 13 each: at most 128 together.
    assert_eq!(names.len(), 11, "{names:?}");
    for k in 1..5 {
        assert!(names.contains(&format!("d{k}_d{}_contact", k + 1).as_str()), "{names:?}");
    }
    let line = found.left_out.iter().find(|line| line.starts_with("contacts that do not fit into the 128"));
    assert!(
        line.is_some_and(|line| line.ends_with("d1_d4_contact, d2_d5_contact, d1_d5_contact")),
        "{line:?}"
    );
}

/// A chain has its contacts with itself only if all of them fit.
#[test]
fn contacts_of_one_robot_are_complete_or_absent() {
    for (links, contacts) in [(5, 6), (9, 0)] {
        let chain = |link: &str| {
            format!(
                "{}{}",
                format!("<body pos='1 0 0'><joint axis='0 1 0'/>{link}").repeat(links),
                "</body>".repeat(links)
            )
        };
        let body = chain("<geom type='capsule' size='.1 .2'/>");
        let text = format!("<mujoco><worldbody>{body}</worldbody></mujoco>");
        let test = format!("chain{links}");
        let found = hulls::read_description(&test, "mjcf = \"r.xml\", contacts = file", "struct S;", &text);
        let found = found.expect("a mechanism");
        assert_eq!(found.contacts.len(), contacts);
        let line = "contacts of bodies that joints connect, which do not fit into the 128 contact points of \
                    a mechanism: 28";
        assert_eq!(found.left_out.iter().any(|found| found == line), contacts == 0, "{:?}", found.left_out);
    }
}

/// The number of pairs grows with the square of the number of shapes, but that of contacts does not.
#[test]
fn many_shapes_have_a_bounded_number_of_contacts() {
    let balls: String =
        (0..200).map(|k| format!("<body pos='{k} 0 0'><freejoint/><geom size='.1'/></body>")).collect();
    let (found, left_out) =
        import_contacts(ContactOption::File, &format!("<mujoco><worldbody>{balls}</worldbody></mujoco>"))
            .expect("a mechanism");
    assert!(
        found.len() <= 128 && left_out.iter().any(|line| line.contains("distant bodies")),
        "{left_out:?}"
    );
}
