import { Button, PasswordInput, Stack } from "@mantine/core";
import { useState, type ReactNode, type SubmitEvent } from "react";

const SHORTEST = 12;

/** A new password, entered twice; `first` is above the fields and `children` below them. */
export function NewPassword({
  label,
  action,
  pending,
  focused = false,
  first,
  children,
  onSubmit,
}: {
  label: string;
  action: string;
  pending: boolean;
  focused?: boolean;
  first?: ReactNode;
  children?: ReactNode;
  onSubmit: (password: string, clear: () => void) => void;
}) {
  const [password, setPassword] = useState("");
  const [again, setAgain] = useState("");
  const differs = again !== "" && again !== password;
  const submit = (event: SubmitEvent) => {
    event.preventDefault();
    onSubmit(password, () => {
      setPassword("");
      setAgain("");
    });
  };
  return (
    <form onSubmit={submit}>
      <Stack gap="sm" maw={360}>
        {first}
        <PasswordInput
          label={label}
          description={`At least ${String(SHORTEST)} characters`}
          autoComplete="new-password"
          autoFocus={focused}
          required
          minLength={SHORTEST}
          value={password}
          onChange={(event) => {
            setPassword(event.currentTarget.value);
          }}
        />
        <PasswordField
          label="Repeat password"
          autoComplete="new-password"
          error={differs && "The passwords differ"}
          value={again}
          onChange={setAgain}
        />
        {children}
        <Button
          type="submit"
          loading={pending}
          disabled={again !== password}
          data-testid="set-password"
        >
          {action}
        </Button>
      </Stack>
    </form>
  );
}

export function PasswordField({
  onChange,
  ...field
}: {
  label: string;
  autoComplete: string;
  value: string;
  error?: ReactNode;
  onChange: (value: string) => void;
}) {
  return (
    <PasswordInput
      required
      {...field}
      onChange={(event) => {
        onChange(event.currentTarget.value);
      }}
    />
  );
}
