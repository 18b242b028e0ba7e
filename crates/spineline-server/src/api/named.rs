//! Named values of the library, as strings.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};
use spineline::action::LineKind;
use spineline::anatomy::{FilmView, ImageSide, Named, Posture, Side};
use spineline::measure::SpacingPlane;
use spineline_files::ExportFormat;
use spineline_marking::Calibrator;
use spineline_store::{Access, Role};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ObjectBuilder, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

/// A named value as the interface describes it.
pub trait Described: Named {
    /// Name of its schema.
    const SCHEMA: &'static str;
    /// Description of the values.
    const DESCRIPTION: &'static str;
}

/// A named value, with a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Wire<T>(pub T);

impl<T: Described> PartialSchema for Wire<T> {
    fn schema() -> RefOr<Schema> {
        let names = T::ALL.iter().map(|value| value.key());
        ObjectBuilder::new()
            .schema_type(Type::String)
            .description(Some(T::DESCRIPTION))
            .enum_values(Some(names))
            .into()
    }
}

impl<T: Described> ToSchema for Wire<T> {
    fn name() -> Cow<'static, str> {
        T::SCHEMA.into()
    }
}

/// Posture of the patient on a film.
pub type PostureName = Wire<Posture>;
/// What a film shows.
pub type FilmViewName = Wire<FilmView>;
/// The patient's side.
pub type SideName = Wire<Side>;
/// A side of the picture as seen.
pub type ImageSideName = Wire<ImageSide>;
/// Plane of a film's lengths.
pub type PlaneName = Wire<SpacingPlane>;
/// Kind of a line of action.
pub type LineName = Wire<LineKind>;
/// Format of a model for other multibody programs.
pub type ModelFormatName = Wire<ExportFormat>;
/// Object of known size in the picture.
pub type CalibratorName = Wire<Calibrator>;
/// Highest permission of an account; a study may grant less.
pub type RoleName = Wire<Role>;
/// Way of signing in.
pub type AccessName = Wire<Access>;

impl Described for Posture {
    const SCHEMA: &'static str = "PostureName";
    const DESCRIPTION: &'static str = "Posture of the patient on a film.";
}

impl Described for FilmView {
    const SCHEMA: &'static str = "FilmViewName";
    const DESCRIPTION: &'static str =
        "What a film shows: the posture of the patient on a frontal film, or the lateral film.";
}

impl Described for Side {
    const SCHEMA: &'static str = "SideName";
    const DESCRIPTION: &'static str = "The patient's side.";
}

impl Described for ImageSide {
    const SCHEMA: &'static str = "ImageSideName";
    const DESCRIPTION: &'static str = "A side of the picture as seen.";
}

impl Described for SpacingPlane {
    const SCHEMA: &'static str = "PlaneName";
    const DESCRIPTION: &'static str = "Plane of a film's lengths.";
}

impl Described for LineKind {
    const SCHEMA: &'static str = "LineName";
    const DESCRIPTION: &'static str = "Kind of a line of action.";
}

impl Described for ExportFormat {
    const SCHEMA: &'static str = "ModelFormatName";
    const DESCRIPTION: &'static str = "Format of a model for other programs.";
}

impl Described for Calibrator {
    const SCHEMA: &'static str = "CalibratorName";
    const DESCRIPTION: &'static str = "Object of known size in the picture.";
}

impl Described for Role {
    const SCHEMA: &'static str = "RoleName";
    const DESCRIPTION: &'static str = "Highest permission of an account; a study may grant less.";
}

impl Described for Access {
    const SCHEMA: &'static str = "AccessName";
    const DESCRIPTION: &'static str = "Way of signing in.";
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Highest permission of an account; a study may grant less.
    #[derive(ToSchema)]
    #[schema(rename_all = "snake_case")]
    #[allow(dead_code)]
    enum RoleName {
        Reader,
        Editor,
        Admin,
    }

    #[test]
    fn the_schema_of_a_named_value_equals_that_of_a_derived_enum() {
        let text = |schema: RefOr<Schema>| serde_json::to_string(&schema).expect("a schema");
        assert_eq!(text(Wire::<Role>::schema()), text(RoleName::schema()));
        assert_eq!(Wire::<Role>::name(), RoleName::name());
    }
}
