import { TextInput, type TextInputProps } from "@mantine/core";
import { useEffect, useState } from "react";

interface Props extends Omit<TextInputProps, "value" | "onChange"> {
  value: string;
  onCommit: (text: string) => void;
}

const PAUSE_MS = 350;

/** Text that is passed on when typing pauses, so that not every letter is a request. */
export function FilterInput({ value, onCommit, ...props }: Props) {
  const [text, setText] = useState(value);
  const [known, setKnown] = useState(value);
  if (value !== known) {
    // Back, or another link, changed the filter.
    setKnown(value);
    setText(value);
  }
  useEffect(() => {
    if (text === known) return;
    const timer = setTimeout(() => {
      setKnown(text);
      onCommit(text);
    }, PAUSE_MS);
    return () => {
      clearTimeout(timer);
    };
  }, [text, known, onCommit]);
  return (
    <TextInput
      {...props}
      value={text}
      onChange={(event) => {
        setText(event.currentTarget.value);
      }}
      onKeyDown={(event) => {
        if (event.key !== "Enter" || text === known) return;
        setKnown(text);
        onCommit(text);
      }}
    />
  );
}
