//! Records, messages and directions from the table.

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

            /// The names alone: a device that numbers its fields has no use for their meanings.
            const NAMES: &'static [&'static str] = &[$( stringify!($field), )+];

            /// Position of a field in the message, counted from 0: the `detail` of an [`Ack`] that refuses its value.
            #[must_use]
            pub const fn field_number(name: &str) -> Option<u32> {
                position(Self::NAMES, name)
            }
        }

        impl Wire for $Record {
            const FIXED_LEN: usize = 0 $( + <$Type $(<$Arg>)? as Wire>::FIXED_LEN )+;
            const ELEMENT_LEN: usize = 0 $( + <$Type $(<$Arg>)? as Wire>::ELEMENT_LEN )+;

            fn read(reader: &mut Reader<'_>) -> Result<Self, PayloadError> {
                Ok(Self { $( $field: Wire::read(reader)?, )+ })
            }

            fn skip(reader: &mut Reader<'_>) -> Result<(), PayloadError> {
                $( <$Type $(<$Arg>)? as Wire>::skip(reader)?; )+
                Ok(())
            }

            fn write(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
                $( self.$field.write(writer)?; )+
                Ok(())
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

            /// Delivery of this message.
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
                    $( $message_type => Some(read::<$Message, Self>(reader)), )+
                    _ => None,
                }
            }
        }
    };
}
