//! What zones of a controller do not express is named, and nothing that they say instead is wrong.

use crate::common::zone_reader::{krl, rapid};
use crate::common::{ARM, HEAD, rail};
use elbowroom_cell::{Cell, ZoneExport, ZoneFrame, ZoneLanguage, export_zones};
use elbowroom_robot::RobotId;

const BOTH: [ZoneLanguage; 2] = [ZoneLanguage::Rapid, ZoneLanguage::Krl];

fn export(tables: &str, language: ZoneLanguage) -> ZoneExport {
    let text = format!("{HEAD}[robot.arm]\n{ARM}{}{tables}", rail("other", 4000.0));
    let cell = Cell::parse("c.toml", &text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let frame = ZoneFrame::new(&cell, RobotId(0), None).unwrap();
    export_zones(&cell, RobotId(0), &frame, language)
}

fn missing(exported: &ZoneExport) -> Vec<String> {
    exported.regions.iter().flat_map(|region| &region.missing).map(ToString::to_string).collect()
}

fn zones(exported: &ZoneExport, language: ZoneLanguage) -> usize {
    match language {
        ZoneLanguage::Rapid => rapid(&exported.text).len(),
        ZoneLanguage::Krl => krl(&exported.text).len(),
    }
}

const BOX: &str = "shape = \"box\"\nbase = [900, 0, 0]\nsize = [300, 200, 450]\nwarning = 100\n";
const TCP: &str = "guards = [\"tcp\"]\n";

/// A table without its head, the languages, how many zones it has, and what is said to be missing.
type Gap = (String, &'static [ZoneLanguage], usize, &'static str);

fn gaps() -> Vec<Gap> {
    let sphere = "shape = \"sphere\"\ncentre = [900, 0, 500]\nradius = 100\nwarning = 100\n";
    let cylinder = "shape = \"cylinder\"\nbase = [900, 0, 0]\nradius = 100\nheight = 500\nwarning = 100\n";
    let capsule = "shape = \"capsule\"\nat = [900, 0, 500]\nradius = 100\nheight = 500\nwarning = 100\n";
    let plane = "shape = \"plane\"\norigin = [0, 0, -100]\nx = [100, 0, -100]\ny = [0, 100, -90]\nwarning = 100\n";
    let rapid = &BOTH[..1];
    let krl = &BOTH[1..];
    vec![
        (BOX.to_owned(), &BOTH, 1, "a zone watches the tool centre point, and does not guard the arm"),
        (format!("{BOX}guards = [\"tcp\", \"tool\"]"), &BOTH, 1, "and does not guard the tool"),
        (format!("{BOX}guards = [\"tool\", \"arm\"]"), &BOTH, 1, "and does not guard the tool and the arm"),
        (format!("{BOX}{TCP}rpy = [0, 0, 25]"), rapid, 0, "it is turned against the axes of the frame"),
        (format!("{cylinder}{TCP}rpy = [8, 0, 0]"), rapid, 0, "it is turned against the axes of the frame"),
        (format!("{plane}{TCP}"), rapid, 0, "it is turned against the axes of the frame"),
        (format!("{sphere}{TCP}"), krl, 0, "a workspace is a box, and this is a sphere"),
        (format!("{cylinder}{TCP}"), krl, 0, "a workspace is a box, and this is a cylinder"),
        (format!("{capsule}{TCP}"), &BOTH, 0, "controllers have no zone of the shape capsule"),
        (
            format!("{sphere}{TCP}follow = {{ robot = \"other\", frame = \"flange\" }}"),
            &BOTH,
            0,
            "it follows robot \"other\", and zones of a controller do not move",
        ),
        (format!("{BOX}{TCP}kind = \"exchange\""), &BOTH, 0, "it is open to one robot at a time"),
        (format!("{BOX}{TCP}kind = \"exchange\"\noutput = 3"), &BOTH, 1, "it is open to one robot at a time"),
        (format!("{BOX}{TCP}kind = \"monitored\""), &BOTH, 0, "neither `output` nor `warning_output`"),
        (
            format!("{BOX}{TCP}kind = \"monitored\"\nslow_to = 30\noutput = 3"),
            &BOTH,
            1,
            "`slow_to` has no counterpart: a zone does not limit the override to 30 %",
        ),
        (format!("{BOX}{TCP}output = 3\nhysteresis = 20"), &BOTH, 1, "an output falls at the border, not 20 mm beyond"),
        (format!("{BOX}{TCP}output = 3\nwarning_output = 3"), &BOTH, 1, "output 3 is not set: 2 zones have it"),
        (
            format!("{BOX}{TCP}keep = \"inside\"\nwarning_output = 3"),
            &BOTH,
            1,
            "warning zone: it covers all that is free",
        ),
        (format!("{BOX}{TCP}output = 0"), krl, 1, "output 0 is not set: the first output is $OUT[1]"),
        (format!("{BOX}{TCP}kind = \"monitored\"\noutput = 0"), krl, 0, "output 0 is not set"),
    ]
}

#[test]
fn everything_that_a_language_lacks_is_named_at_its_line() {
    for (keys, languages, count, reason) in gaps() {
        for language in languages {
            // RAPID takes a zone for the stop and one for the output.
            let exported = export(&format!("[region.r]\n{keys}\n"), *language);
            let missing = missing(&exported);
            let [only] = &missing[..] else { panic!("{language:?} {keys}: {missing:?}") };
            let line = exported.regions[0].missing[0].line;
            assert!(
                only.starts_with("c.toml:") && line.is_some() && only.contains(reason),
                "{language:?} {keys}: {only}"
            );
            assert!(only.contains("region \"r\"") && !exported.is_complete());
            assert!(exported.text.contains(reason), "{}", exported.text);
            assert!(exported.text.contains("NOT EXPRESSED:"));
            let has_both = *language == ZoneLanguage::Rapid && keys.contains("\noutput = 3\nhysteresis");
            assert_eq!(
                zones(&exported, *language),
                count + usize::from(has_both),
                "{language:?} {keys}\n{}",
                exported.text
            );
        }
    }
}

#[test]
fn a_plane_needs_a_reach_with_an_end() {
    let endless =
        |max: &str| format!("[robot.slide]\ndh = [{{ kind = \"prismatic\", min = 0, max = {max}, speed = 1000 }}]\n");
    let plane =
        "[region.r]\nshape = \"plane\"\norigin = [0, 0, -100]\nx = [100, 0, -100]\ny = [0, 100, -100]\nwarning = 9\n";
    for (max, is_written) in [("9e5", true), ("2e6", false)] {
        let cell = Cell::parse("c.toml", &format!("{HEAD}{}{plane}{TCP}", endless(max))).unwrap();
        let frame = ZoneFrame::new(&cell, RobotId(0), None).unwrap();
        let exported = export_zones(&cell, RobotId(0), &frame, ZoneLanguage::Rapid);
        assert_eq!(exported.is_complete(), is_written, "{max}: {:?}", missing(&exported));
        assert!(is_written || missing(&exported)[0].contains("reach, and that is more than 1 km"));
    }
}

#[test]
fn other_robots_regions_are_left_out() {
    let tables =
        format!("[region.of_other]\n{BOX}{TCP}robots = [\"other\"]\n[region.of_arm]\n{BOX}{TCP}robots = [\"arm\"]\n");
    let exported = export(&tables, ZoneLanguage::Krl);
    assert_eq!(exported.regions.iter().map(|region| region.region.0).collect::<Vec<_>>(), [1]);
    assert!(exported.is_complete() && !exported.text.contains("of_other"));
}

#[test]
fn an_output_of_two_regions_is_set_by_neither() {
    let one = format!("[region.a]\n{BOX}{TCP}output = 3\n");
    let two = format!("[region.b]\n{BOX}{TCP}kind = \"monitored\"\noutput = 3\n");
    for language in BOTH {
        let exported = export(&format!("{one}{two}"), language);
        assert!(!exported.text.contains("$OUT[3]") && !exported.text.contains("doElbowroom3,"), "{}", exported.text);
        assert_eq!((missing(&exported).len(), zones(&exported, language)), (2, 1));
        let exported = export(&one, language);
        assert!(exported.text.contains("$OUT[3]") || exported.text.contains("doElbowroom3,"), "{}", exported.text);
    }
}

#[test]
fn eight_workspaces_go_to_what_stops_first_and_a_region_is_whole_or_missing() {
    let signal = |i: usize| format!("[region.s{i}]\n{BOX}{TCP}kind = \"monitored\"\noutput = {}\n", i + 1);
    let stop = |i: usize| format!("[region.f{i}]\n{BOX}{TCP}");
    let signals: String = (0..5).map(signal).collect();
    let stops: String = (0..4).map(stop).collect();
    let exported = export(&format!("{signals}{stops}"), ZoneLanguage::Krl);
    let lost = missing(&exported);
    assert_eq!(zones(&exported, ZoneLanguage::Krl), 8);
    assert!(
        lost.len() == 1 && lost[0].contains("region \"s4\", outputs: it takes a workspace, and none of the 8 is free"),
        "{lost:?}"
    );
    // Six parts of walls, and four left.
    let fence = "[fence.cell]\ncorners = [[-1200, -1800], [1900, -1800], [1900, 900], [-1200, 900]]\nheight = 2000\n\
                 gates = [{ from = [1900, -450], to = [1900, 450], top = 1000 }]\nwarning = 200\nguards = [\"tcp\"]\n";
    let exported = export(&format!("{stops}{fence}"), ZoneLanguage::Krl);
    assert_eq!((zones(&exported, ZoneLanguage::Krl), missing(&exported).len()), (4, 1));
    assert!(missing(&exported)[0].contains("region \"cell\": it takes 6 workspaces, and 4 of the 8 are free"));
    // RAPID has no such limit.
    assert!(export(&format!("{signals}{stops}{fence}"), ZoneLanguage::Rapid).is_complete());
}

#[test]
fn walls_that_are_not_parallel_are_named_and_the_others_written() {
    let fence = "[fence.cell]\ncorners = [[-1200, -1800], [1900, -1800], [1900, 900], [-1000, 1200]]\nheight = 2000\nwarning = 200\nguards = [\"tcp\"]\n";
    let exported = export(fence, ZoneLanguage::Rapid);
    let lost = missing(&exported);
    assert_eq!((zones(&exported, ZoneLanguage::Rapid), lost.len()), (2, 2));
    assert!(lost[0].contains("region \"cell\", part 3 of its walls: it is turned"), "{lost:?}");
    assert!(export(fence, ZoneLanguage::Krl).is_complete());
}

/// Text of a cell file cannot become an instruction of a controller.
#[test]
fn names_stay_in_comments() {
    let name = "name = \"c\\nENDMODULE\\n$WORKSPACE[1]={MODE #OFF}\"\n";
    let region = format!(
        "[region.\"Zone; ENDPROC ! ü {{MODE #OFF}} and a name that is longer than others\"]\n{BOX}{TCP}output = 1\n"
    );
    let text = format!("{HEAD}{name}[robot.arm]\n{ARM}{region}");
    let cell = Cell::parse("c.toml", &text).unwrap_or_else(|e| panic!("{e}"));
    let frame = ZoneFrame::new(&cell, RobotId(0), None).unwrap();
    for (language, count) in [(ZoneLanguage::Rapid, 2), (ZoneLanguage::Krl, 1)] {
        let exported = export_zones(&cell, RobotId(0), &frame, language);
        assert_eq!(zones(&exported, language), count, "{}", exported.text);
        assert!(exported.text.contains("cell \"c?ENDMODULE?$WORKSPACE[1]={MODE #OFF}\""), "{}", exported.text);
    }
}

#[test]
fn no_region_is_a_text_without_zones() {
    for language in BOTH {
        let exported = export("", language);
        assert!(exported.is_complete() && exported.regions.is_empty() && zones(&exported, language) == 0);
    }
}
