//! Settings in files: what is not named is the default's, unknown keys are refused.

use plotter_vector::follow::{CameraSettings, MappingSettings, PublishedSettings};
use plotter_vector::svg_in::SvgOptions;
use plotter_vector::{Mode, Ours, Vectorizer, trace::Published};
use std::fmt::Debug;

fn read_with_default<T: Default + Debug + PartialEq + serde::de::DeserializeOwned>(key: &str) {
    assert_eq!(toml::from_str::<T>("").unwrap(), T::default());
    assert_ne!(toml::from_str::<T>(key).unwrap(), T::default(), "{key}");
    let refused = toml::from_str::<T>("sped = 1").unwrap_err().to_string();
    assert!(refused.contains("unknown field `sped`"), "{refused}");
}

#[test]
fn settings_are_read_with_their_defaults() {
    read_with_default::<SvgOptions>("paper = \"#f0f0e8\"");
    assert!(toml::from_str::<SvgOptions>("paper = \"white\"").is_err());
    read_with_default::<MappingSettings>("max_tries = 3");
    read_with_default::<PublishedSettings>("level = 77");
    read_with_default::<CameraSettings>("lens = { barrel = 0.05 }");
    read_with_default::<Ours>("tolerance_px = 0.25");
    read_with_default::<Published>("simplification = { k_px = 12 }");
    read_with_default::<Vectorizer>("algorithm = { published = {} }");
}

#[test]
fn a_vectorizer_has_the_settings_of_its_own_algorithm_only() {
    let text = "threshold = { keep_pale = true }\n[algorithm.ours]\nmode = \"outline\"\norder = { effort = \"fast\" }";
    let read: Vectorizer = toml::from_str(text).unwrap();
    assert_eq!(read.ours().map(|ours| ours.mode), Some(Mode::Outline));
    assert!(read.threshold.keep_pale);
    for text in ["[algorithm.published]\nmode = \"outline\"", "[algorithm.ours]\nsimplification = {}"] {
        assert!(
            toml::from_str::<Vectorizer>(text).unwrap_err().to_string().contains("unknown field"),
            "{text}"
        );
    }
}
