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

/// A named value, with a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Wire<T>(pub T);

impl<T: Named> PartialSchema for Wire<T> {
    fn schema() -> RefOr<Schema> {
        let names = T::ALL.iter().map(|value| value.key());
        ObjectBuilder::new()
            .schema_type(Type::String)
            .description(Some(T::description()))
            .enum_values(Some(names))
            .into()
    }
}

impl<T: Named> ToSchema for Wire<T> {
    fn name() -> Cow<'static, str> {
        format!("{}Name", T::TYPE).into()
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
/// Unit of a film's lengths.
pub type SpacingPlaneName = Wire<SpacingPlane>;
/// Kind of a line of action.
pub type LineKindName = Wire<LineKind>;
/// Format of a model for other multibody programs.
pub type ExportFormatName = Wire<ExportFormat>;
/// Object of known size in the picture.
pub type CalibratorName = Wire<Calibrator>;
/// Highest permission of an account; a study may grant less.
pub type RoleName = Wire<Role>;
/// Way of signing in.
pub type AccessName = Wire<Access>;

#[cfg(test)]
mod tests {
    use super::*;

    /// Permissions in increasing order; each includes those before it.
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
