//! The macro that turns the table in `message.rs` into types, encoders, decoders, layouts and the schema text.

#[macro_use]
mod codes;
#[macro_use]
mod messages;

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
