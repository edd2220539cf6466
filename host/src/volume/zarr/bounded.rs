//! Compressed chunks that may not become longer than their shape says.
//!
//! The codecs of zarrs decode whatever is there: a few bytes can stand for gigabytes. These stop at the length that a
//! chunk has by its shape and type, and are put in their place, for this process.

use std::any::Any;
use std::borrow::Cow;
use std::io::{self, Read};
use std::sync::{Arc, Once};

use zarrs::array::codec::api::{
    CodecRuntimePluginV2, CodecRuntimePluginV3, PartialDecoderCapability, PartialEncoderCapability,
    register_codec_v2, register_codec_v3,
};
use zarrs::array::codec::{BloscCodec, Bz2Codec, GzipCodec, ZlibCodec, ZstdCodec};
use zarrs::array::{
    ArrayBytesRaw, BytesRepresentation, BytesToBytesCodecTraits, Codec, CodecError, CodecMetadataOptions,
    CodecOptions, CodecTraits, CodecTraitsV2, CodecTraitsV3, RecommendedConcurrency,
};
use zarrs::metadata::Configuration;
use zarrs::plugin::{ExtensionAliases, ExtensionName, ZarrVersion, ZarrVersion2, ZarrVersion3};

/// Puts codecs that stop in time in the place of those that do not.
pub(super) fn bound_codecs() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        bound::<GzipCodec>(|encoded, most| read(flate2::read::MultiGzDecoder::new(encoded), most));
        bound::<ZlibCodec>(|encoded, most| read(flate2::read::ZlibDecoder::new(encoded), most));
        bound::<Bz2Codec>(|encoded, most| read(bzip2::read::MultiBzDecoder::new(encoded), most));
        bound::<ZstdCodec>(|encoded, most| read(zstd::stream::read::Decoder::new(encoded)?, most));
        bound::<BloscCodec>(blosc);
    });
}

/// Decodes bytes, unless they become more than so many; `None` if the codec of zarrs can be trusted with them.
type Decode = fn(&[u8], u64) -> io::Result<Option<Vec<u8>>>;

fn read(decoder: impl Read, most: u64) -> io::Result<Option<Vec<u8>>> {
    let mut decoded = Vec::new();
    decoder.take(most.saturating_add(1)).read_to_end(&mut decoded)?;
    if decoded.len() as u64 > most { Err(too_long()) } else { Ok(Some(decoded)) }
}

/// The head of Blosc says how many bytes there will be, and they are not more.
fn blosc(encoded: &[u8], most: u64) -> io::Result<Option<Vec<u8>>> {
    let head = encoded.get(4..8).and_then(|bytes| bytes.try_into().ok());
    let bytes = head.map_or(0, u32::from_le_bytes);
    if u64::from(bytes) > most { Err(too_long()) } else { Ok(None) }
}

fn too_long() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "a chunk has more bytes than its shape says")
}

fn bound<T>(decode: Decode)
where
    T: CodecTraitsV2
        + CodecTraitsV3
        + ExtensionAliases<ZarrVersion2>
        + ExtensionAliases<ZarrVersion3>
        + 'static,
{
    let bounded = move |codec| match codec {
        Codec::BytesToBytes(inner) => Codec::BytesToBytes(Arc::new(Bounded { inner, decode })),
        other => other,
    };
    register_codec_v2(CodecRuntimePluginV2::new(
        <T as ExtensionAliases<ZarrVersion2>>::matches_name,
        move |metadata| <T as CodecTraitsV2>::create(metadata).map(bounded),
    ));
    register_codec_v3(CodecRuntimePluginV3::new(
        <T as ExtensionAliases<ZarrVersion3>>::matches_name,
        move |metadata| <T as CodecTraitsV3>::create(metadata).map(bounded),
    ));
}

/// A codec that stops in time.
#[derive(Debug)]
struct Bounded {
    inner: Arc<dyn BytesToBytesCodecTraits>,
    decode: Decode,
}

impl ExtensionName for Bounded {
    fn name(&self, version: ZarrVersion) -> Option<Cow<'static, str>> {
        self.inner.name(version)
    }
}

impl CodecTraits for Bounded {
    fn as_any(&self) -> &dyn Any {
        self
    }

    fn configuration(&self, version: ZarrVersion, options: &CodecMetadataOptions) -> Option<Configuration> {
        self.inner.configuration(version, options)
    }

    fn partial_decoder_capability(&self) -> PartialDecoderCapability {
        PartialDecoderCapability { partial_read: false, partial_decode: false }
    }

    fn partial_encoder_capability(&self) -> PartialEncoderCapability {
        PartialEncoderCapability { partial_encode: false }
    }
}

impl BytesToBytesCodecTraits for Bounded {
    fn into_dyn(self: Arc<Self>) -> Arc<dyn BytesToBytesCodecTraits> {
        self
    }

    fn recommended_concurrency(
        &self,
        decoded: &BytesRepresentation,
    ) -> Result<RecommendedConcurrency, CodecError> {
        self.inner.recommended_concurrency(decoded)
    }

    fn encoded_representation(&self, decoded: &BytesRepresentation) -> BytesRepresentation {
        self.inner.encoded_representation(decoded)
    }

    fn encode<'a>(
        &self,
        decoded: ArrayBytesRaw<'a>,
        options: &CodecOptions,
    ) -> Result<ArrayBytesRaw<'a>, CodecError> {
        self.inner.encode(decoded, options)
    }

    fn decode<'a>(
        &self,
        encoded: ArrayBytesRaw<'a>,
        decoded: &BytesRepresentation,
        options: &CodecOptions,
    ) -> Result<ArrayBytesRaw<'a>, CodecError> {
        let most = decoded.size().unwrap_or(super::layout::LARGEST_BYTES);
        match (self.decode)(&encoded, most).map_err(|cause| CodecError::IOError(Arc::new(cause)))? {
            Some(decoded) => Ok(Cow::Owned(decoded)),
            None => self.inner.decode(encoded, decoded, options),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn what_grows_beyond_its_length_is_refused() {
        let long = vec![7_u8; 1 << 20];
        let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        gzip.write_all(&long).unwrap();
        let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        zlib.write_all(&long).unwrap();
        let [gzip, zlib] = [gzip.finish().unwrap(), zlib.finish().unwrap()];
        let zstd = zstd::encode_all(&long[..], 1).unwrap();
        let gzip_read: Decode = |encoded, most| read(flate2::read::MultiGzDecoder::new(encoded), most);
        let zlib_read: Decode = |encoded, most| read(flate2::read::ZlibDecoder::new(encoded), most);
        let zstd_read: Decode = |encoded, most| read(zstd::stream::read::Decoder::new(encoded)?, most);
        for (encoded, decode) in [(gzip, gzip_read), (zlib, zlib_read), (zstd, zstd_read)] {
            assert!(decode(&encoded, 1 << 20).unwrap() == Some(long.clone()));
            assert_eq!(decode(&encoded, (1 << 20) - 1).unwrap_err().kind(), io::ErrorKind::InvalidData);
        }
        let head = [2, 1, 0, 1, 0, 0, 1, 0];
        assert_eq!(blosc(&head, 1 << 16).unwrap(), None);
        assert_eq!(blosc(&head, (1 << 16) - 1).unwrap_err().kind(), io::ErrorKind::InvalidData);
    }
}
