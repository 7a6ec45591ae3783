//! Settings that are read by serde as their own checks would take them.

/// `Deserialize` for settings with a default: fields that are not there are the default's, unknown ones are
/// refused, and so is what the check refuses. All fields are named, so that none is forgotten.
macro_rules! checked_deserialize {
    ($settings:ident { $($(#[$attribute:meta])* $field:ident: $kind:ty),* $(,)? }, $check:expr) => {
        impl<'de> serde::Deserialize<'de> for $settings {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                #[derive(serde::Deserialize)]
                #[serde(default, deny_unknown_fields)]
                struct Unchecked {
                    $($(#[$attribute])* $field: $kind),*
                }

                impl Default for Unchecked {
                    fn default() -> Self {
                        let $settings { $($(#[$attribute])* $field),* } = $settings::default();
                        Self { $($(#[$attribute])* $field),* }
                    }
                }

                let Unchecked { $($(#[$attribute])* $field),* } = Unchecked::deserialize(deserializer)?;
                let settings = $settings { $($(#[$attribute])* $field),* };
                let checked = ($check)(&settings);
                checked.map_err(serde::de::Error::custom).map(|()| settings)
            }
        }
    };
}

pub(crate) use checked_deserialize;
