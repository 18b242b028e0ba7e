use super::named;

named! {
    /// How far numbers of a publication were compared with it.
    ///
    /// ```
    /// use spineline::anatomy::SourceCheck;
    /// assert_eq!(SourceCheck::SecondHand.cite("panjabi-1976"), "panjabi-1976 (second-hand)");
    /// assert_eq!(SourceCheck::AtSource.cite("wilke-2017"), "wilke-2017");
    /// ```
    pub enum SourceCheck {
        /// With its text, its abstract or its data.
        AtSource = "at_source" as "compared with the source",
        /// With another text that quotes it.
        SecondHand = "second_hand" as "second-hand: compared with a text that quotes the source",
        /// With no text.
        Unverified = "unverified" as "UNVERIFIED: compared with no text",
    }
}

impl SourceCheck {
    /// Keys of the list of references, with this check where it is not the source itself.
    #[must_use]
    pub fn cite(self, keys: &str) -> String {
        match self {
            Self::AtSource => keys.to_owned(),
            Self::SecondHand => format!("{keys} (second-hand)"),
            Self::Unverified => format!("{keys} (UNVERIFIED)"),
        }
    }
}

/// Published numbers of a typical spine that results rest on. Springs have their sources in their own table
/// ([`StiffnessTable`](crate::multibody::StiffnessTable)).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PublishedNumbers {
    /// The numbers, and of which vertebrae.
    pub numbers: &'static str,
    /// What the program does with them.
    pub used_for: &'static str,
    /// Keys of the list of references.
    pub source: &'static str,
    /// How far they were compared with it.
    pub check: SourceCheck,
}

const fn numbers(
    numbers: &'static str,
    used_for: &'static str,
    source: &'static str,
    check: SourceCheck,
) -> PublishedNumbers {
    PublishedNumbers { numbers, used_for, source, check }
}

impl PublishedNumbers {
    /// All of them.
    pub const ALL: [Self; 18] = {
        const SIZES: &str = "drawn bodies, joint centres, sizes of discs";
        const DISTANCES: &str = "levels on a midline, missing vertebrae, order of levels, pixels of films without a spacing";
        use SourceCheck::{AtSource, SecondHand, Unverified};
        [
            numbers(
                "widths of superior endplates, L5 to T11 and T1",
                SIZES,
                "panjabi-1991, panjabi-1992",
                SecondHand,
            ),
            numbers("widths of superior endplates, T10 to T2", SIZES, "panjabi-1991", Unverified),
            numbers(
                "widths of inferior endplates",
                SIZES,
                "panjabi-1991, panjabi-1992",
                Unverified,
            ),
            numbers(
                "depths of superior endplates",
                SIZES,
                "panjabi-1991, panjabi-1992",
                Unverified,
            ),
            numbers(
                "posterior heights of bodies, L5 to L1 and T1",
                SIZES,
                "panjabi-1991, panjabi-1992",
                SecondHand,
            ),
            numbers("posterior heights of bodies, T12 to T2", SIZES, "panjabi-1991", Unverified),
            numbers(
                "heights of discs, L5/L4 to L1/T12",
                SIZES,
                "shin-2024, bach-2019, yadav-2020",
                SecondHand,
            ),
            numbers(
                "heights of thoracic discs, interpolated between two",
                SIZES,
                "fletcher-2015",
                AtSource,
            ),
            numbers("distances of midpoints, L4 to T2", DISTANCES, "vid-ct", AtSource),
            numbers(
                "distances of midpoints, S1 to L4 and T2 to C7",
                DISTANCES,
                "bruno-2015",
                SecondHand,
            ),
            numbers(
                "sagittal turns of the joints without a lateral film, by level",
                "sagittal shape",
                "bruno-2015",
                SecondHand,
            ),
            numbers(
                "kyphosis and lordosis without a lateral film",
                "sagittal shape",
                "sagittal-ais-2018",
                AtSource,
            ),
            numbers(
                "ratio of the places of the pedicles, L4 to T1",
                "axial rotation",
                "vid-ct",
                AtSource,
            ),
            numbers(
                "ratio of the places of the pedicles, L5 (corrected as at L4)",
                "axial rotation",
                "panjabi-1992",
                Unverified,
            ),
            numbers(
                "distance of the pedicles from the sagittal plane",
                "axial rotation after Drerup",
                "panjabi-1991, panjabi-1992",
                Unverified,
            ),
            numbers("masses of slices of the trunk", "weight as a load", "keenan-2014", AtSource),
            numbers("masses of head, neck and arms", "weight as a load", "winter-2009", SecondHand),
            numbers(
                "ranges of lateral bending",
                "limits of a human spine, prediction by published mobility, completion of corners",
                "white-panjabi-1990",
                Unverified,
            ),
        ]
    };
}
