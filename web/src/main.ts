// Where the page begins.
import { mount } from 'svelte';
import './theme/fonts.css';
import './theme/colors.css';
import './theme/base.css';
import App from './App.svelte';

const target = document.getElementById('page');
if (target) mount(App, { target });
