use std::fmt;

use super::{Named, named};

named! {
    /// A side of the patient, never of the picture.
    pub enum Side {
        /// The patient's left.
        ///
        /// It is +Y.
        Left = "left",
        /// The patient's right.
        ///
        /// It is -Y.
        Right = "right",
    }
}

impl Side {
    /// The other side.
    #[must_use]
    pub const fn opposite(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

named! {
    /// A side of the picture as one looks at it.
    pub enum ImageSide {
        /// Left side of the picture as viewed.
        Left = "image_left",
        /// Right side of the picture as viewed.
        Right = "image_right",
    }
}

impl ImageSide {
    /// The other one.
    #[must_use]
    pub const fn opposite(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

named! {
    /// The position in which a film was taken.
    pub enum Posture {
        /// Standing: the reference.
        Erect = "erect",
        /// Bending to the patient's left.
        LeftBending = "left_bending" as "left bending",
        /// Bending to the patient's right.
        RightBending = "right_bending" as "right bending",
        /// Lying, at rest.
        Neutral = "neutral",
        /// Lying, pulled along the spine.
        Traction = "traction",
    }
}

impl Posture {
    /// The postures into which the erect spine is moved.
    pub const MOVED: [Self; 4] =
        [Self::LeftBending, Self::RightBending, Self::Neutral, Self::Traction];

    /// The side of a bending posture.
    #[must_use]
    pub const fn bend(self) -> Option<Side> {
        match self {
            Self::LeftBending => Some(Side::Left),
            Self::RightBending => Some(Side::Right),
            Self::Erect | Self::Neutral | Self::Traction => None,
        }
    }
}

/// The view of a film of a study.
///
/// # Definition
/// Frontal films show the patient's left and right, one film per posture. The lateral film shows front and back of the standing patient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FilmView {
    /// From the front or from the back.
    Frontal(Posture),
    /// From the side.
    Lateral,
}

impl FilmView {
    /// All views: frontal ones in the order of [`Posture::ALL`], then the lateral one.
    pub const ALL: [Self; 6] = [
        Self::Frontal(Posture::Erect),
        Self::Frontal(Posture::LeftBending),
        Self::Frontal(Posture::RightBending),
        Self::Frontal(Posture::Neutral),
        Self::Frontal(Posture::Traction),
        Self::Lateral,
    ];

    /// The name used in files: the posture of a frontal film, or `lateral`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Frontal(posture) => posture.key(),
            Self::Lateral => "lateral",
        }
    }

    /// The posture on a frontal film.
    #[must_use]
    pub const fn posture(self) -> Option<Posture> {
        match self {
            Self::Frontal(posture) => Some(posture),
            Self::Lateral => None,
        }
    }
}

impl Named for FilmView {
    const TYPE: &'static str = "FilmView";
    const DOC: &'static str =
        "View of a film: the posture of the patient on a frontal film, or the lateral film.";
    const ALL: &'static [Self] = &Self::ALL;

    fn key(self) -> &'static str {
        self.key()
    }

    fn doc(self) -> &'static str {
        match self {
            Self::Frontal(posture) => posture.doc(),
            Self::Lateral => "From the side.",
        }
    }
}

named!(by_key FilmView);

impl From<Posture> for FilmView {
    fn from(posture: Posture) -> Self {
        Self::Frontal(posture)
    }
}

impl fmt::Display for FilmView {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frontal(posture) => posture.fmt(f),
            Self::Lateral => f.pad("lateral"),
        }
    }
}

named! {
    /// A region of the spine that has one curve. Regions go from caudal to cranial.
    pub enum Region {
        /// Thoracolumbar or lumbar.
        ThoracolumbarLumbar = "thoracolumbar_lumbar" as "thoracolumbar/lumbar",
        /// Main thoracic.
        MainThoracic = "main_thoracic" as "main thoracic",
        /// Proximal thoracic.
        ProximalThoracic = "proximal_thoracic" as "proximal thoracic",
    }
}

impl Region {
    /// Place in [`Region::ALL`].
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }
}
