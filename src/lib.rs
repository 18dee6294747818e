//! A scene renderer that follows the light backwards.
