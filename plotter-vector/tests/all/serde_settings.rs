//! Settings in files: what is not named is the default's, unknown keys are refused.

use plotter_vector::follow::{CameraSettings, MappingSettings, PublishedSettings};
use plotter_vector::svg_in::SvgOptions;
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
}
