import { Component, type ReactNode } from "react";
import { ProblemAlert } from "../display/ProblemAlert";

interface Props {
  children: ReactNode;
  /** A new value retries. */
  attempt: unknown;
}

interface State {
  error: Error | null;
  attempt: unknown;
}

/** Error boundary of one figure. */
export class FigureBoundary extends Component<Props, State> {
  override state: State = { error: null, attempt: this.props.attempt };

  static getDerivedStateFromError(error: Error): Partial<State> {
    return { error };
  }

  static getDerivedStateFromProps(props: Props, state: State): Partial<State> | null {
    return props.attempt === state.attempt ? null : { error: null, attempt: props.attempt };
  }

  override render() {
    const { error } = this.state;
    if (error === null) return this.props.children;
    return (
      <ProblemAlert
        error={error}
        onRetry={() => {
          this.setState({ error: null });
        }}
      />
    );
  }
}
