//! The macro that turns the table in `message.rs` into types, encoders, decoders, layouts and the schema text.

/// One record: a struct, its bytes and its layout.
macro_rules! record {
    (
        $(#[doc = $meaning:literal])+
        $Record:ident { $(
            $(#[doc = $field_meaning:literal])+
            $field:ident: $Type:ident $(<$Arg:ident>)?,
        )+ }
    ) => {
        $(#[doc = $meaning])+
        #[derive(Clone, Debug, PartialEq)]
        pub struct $Record {
            $( $(#[doc = $field_meaning])+ pub $field: $Type $(<$Arg>)?, )+
        }

        impl $Record {
            /// The fields in wire order.
            pub const FIELDS: &'static [FieldLayout] = &[$(
                FieldLayout {
                    name: stringify!($field),
                    wire_type: concat!(stringify!($Type) $(, "<", stringify!($Arg), ">")?),
                    fixed_len: <$Type $(<$Arg>)? as Wire>::FIXED_LEN,
                    element_len: <$Type $(<$Arg>)? as Wire>::ELEMENT_LEN,
                    meaning: concat!($($field_meaning),+),
                },
            )+];

            /// Position of a field in the message, counted from 0: the `detail` of an [`Ack`] that refuses its value.
            #[must_use]
            pub const fn field_number(name: &str) -> Option<u32> {
                position(Self::FIELDS, name)
            }
        }

        impl Wire for $Record {
            const FIXED_LEN: usize = 0 $( + <$Type $(<$Arg>)? as Wire>::FIXED_LEN )+;
            const ELEMENT_LEN: usize = 0 $( + <$Type $(<$Arg>)? as Wire>::ELEMENT_LEN )+;

            fn read(reader: &mut Reader<'_>) -> Result<Self, PayloadError> {
                Ok(Self { $( $field: Wire::read(reader)?, )+ })
            }

            fn write(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
                $( self.$field.write(writer)?; )+
                Ok(())
            }
        }
    };
}

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

/// All messages of one direction: the enum over them and its type bytes.
macro_rules! direction {
    (
        $(#[doc = $meaning:literal])+
        $Direction:ident {
            $( $Message:ident = $message_type:literal $Delivery:ident, $message_meaning:expr; )+
        }
    ) => {
        $(#[doc = $meaning])+
        #[derive(Clone, Debug, PartialEq)]
        #[allow(clippy::large_enum_variant, reason = "no allocator; the largest message sizes the buffers anyway")]
        pub enum $Direction {
            $( #[doc = $message_meaning] $Message($Message), )+
        }

        impl $Direction {
            /// Every message of this direction, by type byte.
            pub const LAYOUT: &'static [MessageLayout] = &[$(
                MessageLayout {
                    message_type: $message_type,
                    name: stringify!($Message),
                    delivery: Delivery::$Delivery,
                    meaning: $message_meaning,
                    fields: $Message::FIELDS,
                },
            )+];

            /// How this message is made to arrive.
            #[must_use]
            pub const fn delivery(&self) -> Delivery {
                match self { $( Self::$Message(_) => Delivery::$Delivery, )+ }
            }
        }

        $(
            const _: () = assert!(max_len::<$Message>() <= MAX_PAYLOAD_LEN);

            impl $Message {
                /// The type byte of this message.
                pub const MESSAGE_TYPE: u8 = $message_type;
            }

            impl From<$Message> for $Direction {
                fn from(message: $Message) -> Self {
                    Self::$Message(message)
                }
            }
        )+

        impl Message for $Direction {
            fn message_type(&self) -> u8 {
                match self { $( Self::$Message(_) => $message_type, )+ }
            }
        }

        impl Body for $Direction {
            fn write_payload(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
                match self { $( Self::$Message(message) => message.write(writer), )+ }
            }

            fn read_payload(message_type: u8, payload: &[u8]) -> Option<Result<Self, PayloadError>> {
                let reader = &mut Reader::new(payload);
                match message_type {
                    $( $message_type => Some($Message::read(reader).map(Self::$Message)), )+
                    _ => None,
                }
            }
        }
    };
}

/// The whole interface.
macro_rules! interface {
    (
        protocol $version:literal;
        channels $channels:literal;
        codes { $( $(#[doc = $code_doc:literal])+ $Code:ident $codes:tt )+ }
        flags { $( $(#[doc = $flag_doc:literal])+ $Flag:ident $flags:tt )+ }
        records { $( $(#[doc = $record_doc:literal])+ $Record:ident $record_fields:tt )+ }
        $(#[doc = $host_doc:literal])+
        host $Host:ident { $(
            $(#[doc = $host_message_doc:literal])+
            $host_type:literal $HostMessage:ident $HostDelivery:ident $host_fields:tt
        )+ }
        $(#[doc = $device_doc:literal])+
        device $Device:ident { $(
            $(#[doc = $device_message_doc:literal])+
            $device_type:literal $DeviceMessage:ident $DeviceDelivery:ident $device_fields:tt
        )+ }
    ) => {
        /// Version of the framing, the handshake and the rules; messages are versioned by [`SCHEMA_HASH`](crate::SCHEMA_HASH).
        pub const PROTOCOL_VERSION: u16 = $version;

        /// Most channels in one device, and most elements in a list.
        pub const MAX_CHANNELS: usize = $channels;

        /// The interface in canonical form: one line per definition, ended by a line feed, words separated by one space.
        pub const SCHEMA_TEXT: &str = concat!(
            "softlimb-protocol ", stringify!($version), "\n",
            "list 1..=", stringify!($channels), "\n",
            $( "codes ", stringify!($Code), members!($codes), "\n", )+
            $( "flags ", stringify!($Flag), members!($flags), "\n", )+
            $( "record ", stringify!($Record), fields!($record_fields), "\n", )+
            $( "host ", stringify!($host_type), " ", stringify!($HostMessage), " ", stringify!($HostDelivery),
                fields!($host_fields), "\n", )+
            $( "device ", stringify!($device_type), " ", stringify!($DeviceMessage), " ", stringify!($DeviceDelivery),
                fields!($device_fields), "\n", )+
        );

        /// Every enumeration.
        pub const CODES: &[CodeLayout] = &[$( $Code::LAYOUT, )+];

        /// Every set of flags.
        pub const FLAGS: &[CodeLayout] = &[$( $Flag::LAYOUT, )+];

        /// Every record that lists are made of, with its fields.
        pub const RECORDS: &[(&str, &[FieldLayout])] = &[$( (stringify!($Record), $Record::FIELDS), )+];

        $( code_set! { $(#[doc = $code_doc])+ $Code $codes } )+
        $( flag_set! { $(#[doc = $flag_doc])+ $Flag $flags } )+
        $( record! { $(#[doc = $record_doc])+ $Record $record_fields } )+
        $( record! { $(#[doc = $host_message_doc])+ $HostMessage $host_fields } )+
        $( record! { $(#[doc = $device_message_doc])+ $DeviceMessage $device_fields } )+
        direction! {
            $(#[doc = $host_doc])+
            $Host { $( $HostMessage = $host_type $HostDelivery, concat!($($host_message_doc),+); )+ }
        }
        direction! {
            $(#[doc = $device_doc])+
            $Device { $( $DeviceMessage = $device_type $DeviceDelivery, concat!($($device_message_doc),+); )+ }
        }

        impl $Host {
            /// The session that the sender claims.
            #[must_use]
            pub const fn session(&self) -> u16 {
                match self { $( Self::$HostMessage(message) => message.session, )+ }
            }
        }
    };
}

/// Schema text of the members of an enumeration or of a set of flags.
macro_rules! members {
    ({ $( $(#[doc = $meaning:literal])+ $Member:ident = $code:literal, )+ }) => {
        concat!($( " ", stringify!($Member), "=", stringify!($code) ),+)
    };
}

/// Schema text of the fields of a record.
macro_rules! fields {
    ({ $( $(#[doc = $meaning:literal])+ $field:ident: $Type:ident $(<$Arg:ident>)?, )+ }) => {
        concat!($( " ", stringify!($field), ":", stringify!($Type) $(, "<", stringify!($Arg), ">")? ),+)
    };
}
