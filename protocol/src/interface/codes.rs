//! Enumerations and sets of flags from the table.

/// One enumeration with fixed codes.
macro_rules! code_set {
    (
        $(#[doc = $meaning:literal])+
        $Set:ident { $( $(#[doc = $member_meaning:literal])+ $Member:ident = $code:literal, )+ }
    ) => {
        $(#[doc = $meaning])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $Set {
            $( $(#[doc = $member_meaning])+ $Member = $code, )+
        }

        impl $Set {
            /// The members with their codes.
            pub const LAYOUT: CodeLayout = CodeLayout {
                name: stringify!($Set),
                meaning: concat!($($meaning),+),
                members: &[$( (stringify!($Member), $code, concat!($($member_meaning),+)), )+],
            };
        }

        impl CodeSet for $Set {
            fn from_code(code: u8) -> Option<Self> {
                match code {
                    $( $code => Some(Self::$Member), )+
                    _ => None,
                }
            }

            fn code(self) -> u8 {
                self as u8
            }
        }
    };
}

/// One byte of flags; bits that this version does not know are kept.
macro_rules! flag_set {
    (
        $(#[doc = $meaning:literal])+
        $Set:ident { $( $(#[doc = $member_meaning:literal])+ $MEMBER:ident = $bit:literal, )+ }
    ) => {
        $(#[doc = $meaning])+
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub struct $Set(u8);

        impl $Set {
            /// The flags with their bit numbers.
            pub const LAYOUT: CodeLayout = CodeLayout {
                name: stringify!($Set),
                meaning: concat!($($meaning),+),
                members: &[$( (stringify!($MEMBER), $bit, concat!($($member_meaning),+)), )+],
            };

            $( $(#[doc = $member_meaning])+ pub const $MEMBER: Self = Self(1 << $bit); )+

            /// Every flag that this version knows.
            pub const ALL: Self = Self(0 $(| 1 << $bit)+);

            /// The flags as they stand on the wire.
            #[must_use]
            pub const fn from_bits(bits: u8) -> Self {
                Self(bits)
            }

            /// The flags as they stand on the wire.
            #[must_use]
            pub const fn bits(self) -> u8 {
                self.0
            }

            /// True when every flag of `other` is set.
            #[must_use]
            pub const fn contains(self, other: Self) -> bool {
                self.0 & other.0 == other.0
            }

            /// These flags with those of `other` set or cleared.
            #[must_use]
            pub const fn with(self, other: Self, set: bool) -> Self {
                if set { Self(self.0 | other.0) } else { Self(self.0 & !other.0) }
            }
        }

        impl Wire for $Set {
            const FIXED_LEN: usize = 1;

            fn read(reader: &mut Reader<'_>) -> Result<Self, PayloadError> {
                u8::read(reader).map(Self)
            }

            fn write(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
                self.0.write(writer)
            }
        }
    };
}
