spineline::named! {
    /// File format of a film, by the extension of its files.
    pub enum FilmKind {
        /// DICOM.
        Dicom = "dcm" as "DICOM",
        /// PNG.
        Png = "png" as "PNG",
        /// JPEG.
        Jpeg = "jpg" as "JPEG",
        /// TIFF.
        Tiff = "tif" as "TIFF",
    }
}
