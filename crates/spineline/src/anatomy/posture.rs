use std::fmt;

use super::named;

named!(Side, ImageSide, Posture, FilmView, Region);

/// A side of the **patient**, never of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// The patient's left, +Y.
    Left,
    /// The patient's right, -Y.
    Right,
}

impl Side {
    /// Both sides.
    pub const ALL: [Self; 2] = [Self::Left, Self::Right];

    /// The other side.
    #[must_use]
    pub const fn opposite(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.key())
    }
}

/// A side of the picture as one looks at it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImageSide {
    /// Towards the first column.
    Left,
    /// Towards the last column.
    Right,
}

impl ImageSide {
    /// Both sides.
    pub const ALL: [Self; 2] = [Self::Left, Self::Right];

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Left => "image_left",
            Self::Right => "image_right",
        }
    }

    /// The other one.
    #[must_use]
    pub const fn opposite(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// The position in which a film was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Posture {
    /// Standing: the reference.
    Erect,
    /// Bending to the patient's left.
    LeftBending,
    /// Bending to the patient's right.
    RightBending,
    /// Lying, at rest.
    Neutral,
    /// Lying, pulled along the spine.
    Traction,
}

impl Posture {
    /// All postures, the erect one first.
    pub const ALL: [Self; 5] =
        [Self::Erect, Self::LeftBending, Self::RightBending, Self::Neutral, Self::Traction];

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

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Erect => "erect",
            Self::LeftBending => "left_bending",
            Self::RightBending => "right_bending",
            Self::Neutral => "neutral",
            Self::Traction => "traction",
        }
    }
}

impl fmt::Display for Posture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Erect => "erect",
            Self::LeftBending => "left bending",
            Self::RightBending => "right bending",
            Self::Neutral => "neutral",
            Self::Traction => "traction",
        })
    }
}

/// What a film of a study shows.
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

    /// The name used in files: that of the posture of a frontal film, or `lateral`.
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

/// A region of the spine with one curve of its own, from caudal to cranial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Region {
    /// Thoracolumbar or lumbar.
    ThoracolumbarLumbar,
    /// Main thoracic.
    MainThoracic,
    /// Proximal thoracic.
    ProximalThoracic,
}

impl Region {
    /// All regions, caudal first; the index of a region is its place here.
    pub const ALL: [Self; 3] =
        [Self::ThoracolumbarLumbar, Self::MainThoracic, Self::ProximalThoracic];

    /// Place in [`Region::ALL`].
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::ThoracolumbarLumbar => "thoracolumbar_lumbar",
            Self::MainThoracic => "main_thoracic",
            Self::ProximalThoracic => "proximal_thoracic",
        }
    }
}

impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::ThoracolumbarLumbar => "thoracolumbar/lumbar",
            Self::MainThoracic => "main thoracic",
            Self::ProximalThoracic => "proximal thoracic",
        })
    }
}
